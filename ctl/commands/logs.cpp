// SPDX-License-Identifier: LGPL-3.0-or-later
#include <chrono>
#include <ctime>
#include <string>

#include "cli/interrupt.h"
#include "commands/actions.h"
#include "commands/log_time.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using namespace std::chrono_literals;
using protocol::wrong_use;

std::variant<Json, Fault> params_of(const Arguments& given) {
  Json params = {{"follow", given.has("-f,--follow")}};
  if (given.has("COMPONENT")) params["component"] = given.one("COMPONENT");
  if (given.has("--level")) params["level"] = given.one("--level");
  if (given.has("--grep")) params["grep"] = given.one("--grep");
  if (given.has("--since")) {
    const auto since = since_when(given.one("--since"), std::chrono::system_clock::now());
    if (!since) {
      return wrong_use("usage_not_a_time", "'" + given.one("--since") + "' is no time", {},
                       "examples: --since 10min, --since 12:30, --since 2026-01-31T12:00:00Z");
    }
    params["since"] = *since;
  }
  if (given.has("-n,--lines")) {
    const auto count = count_of(given.one("-n,--lines"));
    if (!count) {
      return wrong_use("usage_not_a_count", "-n takes a count", given.one("-n,--lines"),
                       "example: mauvectl logs -n 50");
    }
    params["n"] = *count;
  }
  return params;
}

/// The events that are missing from the output, which a reader would not notice otherwise.
struct Dropped {
  std::uint64_t lost = 0;  ///< never recorded: rings and queues were full
  std::uint64_t gone = 0;  ///< recorded once, not kept
  std::uint64_t slow = 0;  ///< by this reader

  void report(Session& session) const {
    if (lost + gone + slow == 0) return;
    if (session.screen.json) {
      session.print({{"event", "dropped"}, {"lost", lost}, {"gone", gone}, {"slow", slow}}, {});
      return;
    }
    std::string text;
    const auto add = [&](std::uint64_t count, const char* what) {
      if (count > 0) join(text, std::to_string(count) + " " + what);
    };
    add(lost, "were never recorded: too many were reported at once");
    add(gone, "older ones are not kept any more");
    add(slow, "were dropped: this reader was too slow");
    session.screen.err << painted("events missing here: " + text, Paint::yellow,
                                  session.screen.colour_err)
                       << "\n";
    session.screen.err.flush();
  }
};

/// Until Ctrl-C; a Fault when the daemon goes away.
std::optional<Fault> go_on(Session& session, const Json& sub, Dropped& dropped) {
  const Interrupt interrupt;
  while (!interrupt.came()) {
    Session::end_without_a_reader();
    auto arrived = session.next(std::chrono::steady_clock::now() + 100ms);
    if (auto* fault = std::get_if<Fault>(&arrived)) {
      if (fault->name == "timed_out") continue;
      return std::move(*fault);
    }
    auto& [method, record] = std::get<Notification>(arrived);
    if (!record.is_object() || record.value("sub", Json()) != sub) continue;
    record.erase("sub");
    if (method == "dropped") {
      record["event"] = "dropped";
      dropped.slow += whole_number(record, "count");
    } else if (method != "log") {
      continue;
    }
    if (word(record, "event") == "events_lost") {
      dropped.lost += whole_number(record.value("fields", Json()), "count");
    }
    session.print(record, render_record(record, session.look()));
  }
  return std::nullopt;
}

std::string in_words(const Json& item) {
  const std::string component = word(item, "component");
  const double left = number(item, "left_s");
  return (component.empty() ? "all" : component) + ": " + word(item, "level") +
         (left > 0 ? ", " + seconds_in_words(left) + " still" : "") + "\n";
}

int show_level(Session& session) {
  const auto answer = session.call("log.level", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& levels = std::get<Json>(answer);
  std::string text =
      "log level " + word(levels, "level") + ", by default " + word(levels, "default") + "\n";
  for (const Json& item : list_in(levels, "items")) text += in_words(item);
  session.print(levels, text);
  return 0;
}

}  // namespace

int run_logs(Session& session) {
  if (session.arguments.has("--explain")) return run_explain(session);
  const auto params = params_of(session.arguments);
  if (const auto* fault = std::get_if<Fault>(&params)) return session.fail(*fault);
  const auto answer = session.call("log.tail", std::get<Json>(params));
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  for (const Json& record : list_in(result, "records")) {
    session.print(record, render_record(record, session.look()));
  }
  const Json counted = result.is_object() ? result.value("dropped", Json()) : Json();
  Dropped dropped{whole_number(counted, "lost"), whole_number(counted, "gone")};
  std::optional<Fault> fault;
  if (session.arguments.has("-f,--follow")) {
    fault = go_on(session, result.is_object() ? result.value("sub", Json()) : Json(), dropped);
  }
  dropped.report(session);
  return fault ? session.fail(*fault) : 0;
}

int run_log(Session& session) {
  const Arguments& given = session.arguments;
  const std::string setting = given.one("SETTING");
  if (setting.empty()) return show_level(session);
  const auto equals = setting.find('=');
  const std::string component = equals == std::string::npos ? "" : setting.substr(0, equals);
  Json params = {{"level", setting.substr(equals == std::string::npos ? 0 : equals + 1)}};
  if (!component.empty()) params["component"] = component;
  if (given.has("--for")) params["for"] = given.one("--for");
  const auto answer = session.call("log.set_level", params);
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  const std::string length = word(result, "for");
  session.print(result, "log level of " + (component.empty() ? "all" : component) + " is " +
                            word(result, "level") +
                            (length.empty() || length == "-" ? "" : " for " + length) + "\n");
  return 0;
}

}  // namespace mauve::ctl
