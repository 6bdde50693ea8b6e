// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "actions.h"
#include "words.h"

namespace mauve::ctl {
namespace {

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

/// Prints what arrives until the daemon goes away; Ctrl-C ends the process. Beside what was asked
/// for that is what was `dropped`, or `replaced`.
template <typename Print>
int follow(Session& session, const Json& subscription, std::string_view method, Print print) {
  while (true) {
    auto arrived = session.next();
    if (const auto* fault = std::get_if<Fault>(&arrived)) return session.fail(*fault);
    auto& notification = std::get<Notification>(arrived);
    const std::string& told = notification.method;
    if (told != method && told != "dropped" && told != "replaced") continue;
    if (is_about(notification.params, subscription)) print(std::move(notification.params), told);
  }
}

}  // namespace

int run_watch(Session& session) {
  const auto answer =
      session.call("watch.subscribe", {{"addresses", session.arguments.all("ADDRESS")}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  return follow(session, subscription_of(std::get<Json>(answer)), "value",
                [&](Json params, const std::string& method) {
                  params = sample_line(std::move(params), method);
                  const std::string text = render_sample(params, session.look());
                  session.print(params, text);
                });
}

}  // namespace mauve::ctl
