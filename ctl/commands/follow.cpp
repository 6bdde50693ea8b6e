// SPDX-License-Identifier: LGPL-3.0-or-later
#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "commands/actions.h"
#include "protocol/message.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

constexpr std::chrono::milliseconds kTurn{500};  ///< to notice that nobody reads any more

bool is_about(const Json& params, const Json& subscription) {
  return params.is_object() && params.contains("sub") && params["sub"] == subscription;
}

/// The form that scripts read: the same members for every line.
Json sample_line(Json params, const std::string& method) {
  params.erase("sub");
  if (method == "value") return params;
  params["value"] = nullptr;
  params["status"] = method;
  return params;
}

Json subscription_of(const Json& result) {
  return result.is_object() ? result.value("sub", Json()) : Json();
}

/// Prints the notifications that arrive until the daemon goes away; Ctrl-C ends the process.
/// Besides those of the subscription these are `dropped` and `replaced`.
template <typename Print>
int follow(Session& session, const Json& subscription, std::string_view method, Print print) {
  while (true) {
    Session::end_without_a_reader();
    auto arrived = session.next(std::chrono::steady_clock::now() + kTurn);
    if (const auto* fault = std::get_if<Fault>(&arrived)) {
      if (fault->name == "timed_out") continue;
      return session.fail(*fault);
    }
    auto& notification = std::get<Notification>(arrived);
    const std::string& arrived_as = notification.method;
    if (arrived_as != method && arrived_as != "dropped" && arrived_as != "replaced") continue;
    if (is_about(notification.params, subscription))
      print(std::move(notification.params), arrived_as);
  }
}

/// Which samples are printed.
class Thinning {
 public:
  using Clock = std::chrono::steady_clock;

  Thinning(std::optional<std::chrono::nanoseconds> every, bool changes)
      : every_(every), changes_(changes) {}

  /// Records of lost samples and of replaced resources always pass.
  [[nodiscard]] bool passes(const Json& sample, const std::string& method) {
    if (method != "value") return true;
    const std::string address = word(sample, "address");
    const Json& value = member(sample, "value");
    const auto now = Clock::now();
    const auto last = last_.find(address);
    const bool same = last != last_.end() && last->second.value == value;
    const bool soon = last != last_.end() && every_ && now - last->second.at < *every_;
    if ((changes_ && same) || soon) return false;
    last_[address] = {value, now};
    return true;
  }

 private:
  struct Last {
    Json value;
    Clock::time_point at;
  };
  std::optional<std::chrono::nanoseconds> every_;
  bool changes_;
  std::map<std::string, Last> last_;
};

}  // namespace

int run_watch(Session& session) {
  const std::string every = session.arguments.one("--every");
  const auto interval = timeout_of(every);
  if (!every.empty() && !interval) {
    return session.fail(protocol::wrong_use("usage_not_a_time", "'" + every + "' is no duration",
                                            {},
                                            "example: mauvectl watch odometry.read --every 500ms"));
  }
  Thinning thinning(interval, session.arguments.has("--changes"));
  const auto answer =
      session.call("watch.subscribe", {{"addresses", session.arguments.all("ADDRESS")}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  return follow(session, subscription_of(std::get<Json>(answer)), "value",
                [&](Json params, const std::string& method) {
                  if (!thinning.passes(params, method)) return;
                  params = sample_line(std::move(params), method);
                  const std::string text = render_sample(params, session.look());
                  session.print(params, text);
                });
}

}  // namespace mauve::ctl
