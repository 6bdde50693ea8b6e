// SPDX-License-Identifier: LGPL-3.0-or-later
#include "top/top.h"

#include <chrono>
#include <string>
#include <thread>

#include "cli/terminal.h"
#include "commands/actions.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using namespace std::chrono_literals;
using protocol::wrong_use;

constexpr const char* kCount = "-n,--count";

/// How often, how many times.
struct Pace {
  std::chrono::nanoseconds interval = 1s;
  std::optional<std::uint64_t> count;  ///< none: until it is ended
};

std::variant<Pace, Fault> pace_of(const Arguments& given) {
  constexpr std::chrono::nanoseconds kShortest = 100ms;
  Pace pace;
  if (given.has("--interval")) {
    const auto interval = timeout_of(given.one("--interval"));
    if (!interval || *interval < kShortest) {
      return wrong_use("usage_not_a_time", "--interval takes a time of 100ms or more",
                       given.one("--interval"), "example: --interval 2s");
    }
    pace.interval = *interval;
  }
  if (given.has(kCount)) {
    pace.count = count_of(given.one(kCount));
    if (!pace.count || *pace.count == 0) {
      return wrong_use("usage_not_a_count", "-n takes a count of 1 or more", given.one(kCount),
                       "example: mauvectl top -n 5");
    }
  }
  return pace;
}

/// The newest answers of the daemon, and those of the time before.
struct Watched {
  TopData now;
  TopData before;

  [[nodiscard]] std::optional<Fault> ask(Session& session) {
    auto status = session.call("status.get", Json::object());
    if (auto* fault = std::get_if<Fault>(&status)) return std::move(*fault);
    auto statistics = session.call("stats.get", Json::object());
    if (auto* fault = std::get_if<Fault>(&statistics)) return std::move(*fault);
    before = std::move(now);
    now = {std::get<Json>(std::move(status)), std::get<Json>(std::move(statistics))};
    return std::nullopt;
  }
  [[nodiscard]] std::vector<TopRow> rows() const { return top_rows(now, before); }
};

void print(Session& session, const Watched& watched, const std::vector<TopRow>& rows) {
  Json list = Json::array();
  for (const TopRow& row : rows) list.push_back(to_json(row));
  const Json line = {{"t_ns", number(watched.now.statistics, "t_ns")}, {"components", list}};
  const Look look = session.look();
  session.print(line, render_heading(watched.now.status) + "\n" +
                          top_table(rows, look.width, look.colour) + "\n");
}

/// For scripts: tables, or lines of JSON, one after the other.
int run_batch(Session& session, const Pace& pace) {
  Watched watched;
  auto next = std::chrono::steady_clock::now();
  for (std::uint64_t i = 0; !pace.count || i < *pace.count; ++i) {
    if (i > 0) std::this_thread::sleep_until(next);
    next += pace.interval;
    if (const auto fault = watched.ask(session)) return session.fail(*fault);
    print(session, watched, arranged(watched.rows(), {}));
    if (!session.screen.out.good()) return 1;  // no program reads it any more
  }
  return 0;
}

/// The picture on the terminal, and its changes by keys.
class LiveTop {
 public:
  LiveTop(Session& session, const Pace& pace) : session_(session), pace_(pace) {
    view_.interval = nanoseconds_in_words(static_cast<double>(pace.interval.count()));
  }

  /// The first answer comes before the terminal is changed.
  std::optional<Fault> begin() { return watched_.ask(session_); }

  std::optional<Fault> run(Terminal& terminal) {
    std::uint64_t pictures = 1;
    auto next = std::chrono::steady_clock::now() + pace_.interval;
    while (show(terminal, next)) {
      if (fault_) return fault_;
      if (std::chrono::steady_clock::now() < next) continue;
      if (pace_.count && pictures++ >= *pace_.count) return std::nullopt;
      next = std::chrono::steady_clock::now() + pace_.interval;
      if (view_.paused) continue;
      if (auto fault = watched_.ask(session_)) return fault;
      if (auto fault = ask_details()) return fault;
    }
    return std::nullopt;
  }

 private:
  /// Until a key or the next answer; false: that was all.
  bool show(Terminal& terminal, Terminal::Deadline next) {
    const std::vector<TopRow> rows = arranged(watched_.rows(), view_);
    const TopScene scene{render_heading(watched_.now.status), rows, details_,
                         number(watched_.now.statistics, "t_ns")};
    terminal.draw(top_frame(scene, view_, terminal.extent(), session_.screen.colour_out));
    const auto typed = terminal.wait(next);
    if (!typed) return false;
    const TopView before = view_;
    for (const Key& key : keys_in(*typed)) press(view_, key, rows);
    const bool others = !before.details || before.selected != view_.selected;
    if (view_.details && others) fault_ = ask_details();
    return !view_.quit;
  }

  /// A component may leave meanwhile; then there are none.
  std::optional<Fault> ask_details() {
    details_ = nullptr;
    if (!view_.details) return std::nullopt;
    auto answer = session_.call("stats.get", {{"address", view_.selected}});
    if (auto* fault = std::get_if<Fault>(&answer)) {
      view_.details = false;
      const bool left = fault->name == "unknown_name";
      return left ? std::nullopt : std::optional<Fault>(std::move(*fault));
    }
    const Json& components = list_in(std::get<Json>(answer), "components");
    if (!components.empty()) details_ = components.front();
    return std::nullopt;
  }

  Session& session_;
  Pace pace_;
  Watched watched_;
  TopView view_;
  Json details_;
  std::optional<Fault> fault_;  // of details that were asked for by a key
};

}  // namespace

int run_top(Session& session) {
  const auto asked = pace_of(session.arguments);
  if (const auto* fault = std::get_if<Fault>(&asked)) return session.fail(*fault);
  const Pace pace = std::get<Pace>(asked);
  if (session.arguments.has("-b,--batch") || session.screen.json) return run_batch(session, pace);
  if (!Terminal::is_there()) {
    return session.fail(wrong_use("usage_needs_terminal", "top needs a terminal, and this is none",
                                  {}, "for scripts: mauvectl top -b -n 1"));
  }
  LiveTop live(session, pace);
  auto fault = live.begin();
  if (!fault) {
    Terminal terminal;
    fault = live.run(terminal);
  }
  return fault ? session.fail(*fault) : 0;
}

}  // namespace mauve::ctl
