// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/session.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <iostream>
#include <iterator>
#include <thread>
#include <utility>

#include "base/duration.h"
#include "cli/files.h"
#include "cli/interrupt.h"
#include "protocol/methods.h"

namespace mauve::ctl {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds kQuestion = 5s;
// A change is prepared, proved and committed before its answer: constructing a core may take long.
// So may judging a file, in whose process all its elements are made.
constexpr std::chrono::nanoseconds kChange = 30s;
constexpr std::chrono::nanoseconds kLongestWait = 24h;
constexpr std::chrono::nanoseconds kBetweenTries = 20ms;
// mauved makes a socket that was removed anew within a second.
constexpr std::chrono::nanoseconds kSocketIsBack = 1500ms;

bool is_change(std::string_view method) {
  const protocol::Method* known = protocol::find_method(method);
  return known != nullptr && known->mutation();
}

bool is_urgent(std::string_view method) {
  const protocol::Method* known = protocol::find_method(method);
  return known != nullptr && known->mutation() && known->when_full();
}

/// Done twice, it is as if done once.
bool is_stop(std::string_view method) {
  const protocol::Method* known = protocol::find_method(method);
  return known != nullptr && known->effect == protocol::Effect::stops;
}

/// Another thread or process makes the answer, for example the process that judges a file.
bool is_answered_later(std::string_view method) {
  const protocol::Method* known = protocol::find_method(method);
  return known != nullptr && known->lane == protocol::Lane::later;
}

/// A command may change something in one form only, as stats does.
Fault changes_nothing(std::string_view command) {
  return protocol::wrong_use("usage_changes_nothing",
                             "--if-generation and --reason are for what changes something", {},
                             "asked like this, " + std::string(command) + " changes nothing");
}

}  // namespace

void Session::end_without_a_reader() {
  pollfd output{STDOUT_FILENO, 0, 0};
  if (poll(&output, 1, 0) <= 0 || (output.revents & (POLLERR | POLLHUP)) == 0) return;
  raise(SIGPIPE);
  errno = EPIPE;  // the signal is ignored: an error, as that of a write
  std::cout.setstate(std::ios::badbit);
}

std::optional<std::chrono::nanoseconds> timeout_of(std::string_view text) {
  const auto parsed = parse_duration(text);
  if (!parsed || *parsed <= 0ns || *parsed > kLongestWait) return std::nullopt;
  return *parsed;
}

Fault bad_file(const Error& error) {
  return protocol::wrong_use(error.id, error.message, error.at, error.hint);
}

std::variant<Json, Fault> file_params(const Session& session, std::string_view argument) {
  const std::string file = session.arguments.one(argument);
  if (file == "-") {
    return Json{{"text", std::string{std::istreambuf_iterator<char>(std::cin), {}}},
                {"file", "standard input"}};
  }
  auto stream = open_to_read(file);
  if (!stream) return bad_file(stream.error());
  std::string text{std::istreambuf_iterator<char>(*stream), {}};
  if (text.find('\0') != std::string::npos) {
    return bad_file(refuse({Errc::invalid_value, "json_syntax"}, file,
                           "this is no JSON file: it holds bytes that no text has",
                           "name a file such as architecture.json"));
  }
  return Json{{"text", std::move(text)}, {"file", file}};
}

Session::Session(const Command& asked_command, Arguments asked_arguments, Globals asked_globals,
                 Screen where)
    : command(asked_command),
      arguments(std::move(asked_arguments)),
      globals(std::move(asked_globals)),
      screen(where),
      client_(globals.socket, std::max(timeout_of(globals.timeout).value_or(kQuestion),
                                       timeout_of(globals.wait).value_or(0ns))) {}

std::optional<Fault> Session::connect(bool urgent) {
  const auto wait = timeout_of(globals.wait);
  const auto end = std::chrono::steady_clock::now() + wait.value_or(0ns);
  while (true) {
    auto fault = client_.connect(urgent);
    if (!fault || !wait || fault->code != protocol::kUnreachable) return fault;
    if (std::chrono::steady_clock::now() >= end) {
      fault->message += "; waited " + globals.wait;
      return fault;
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
}

std::variant<Json, Fault> Session::call(std::string_view method, Json params) {
  const bool changes = is_change(method);
  if (!changes && (globals.if_generation || !globals.reason.empty())) {
    return changes_nothing(command.name);
  }
  const bool urgent = is_urgent(method);
  if (!urgent && (!connected_ || urgent_)) {
    if (auto fault = connect(false)) return std::move(*fault);
    connected_ = true;
    urgent_ = false;
  }
  const bool long_work = changes || is_answered_later(method);
  const auto timeout = timeout_of(globals.timeout).value_or(long_work ? kChange : kQuestion);
  if (changes) {
    if (globals.if_generation) params["if_generation"] = *globals.if_generation;
    if (!globals.reason.empty()) params["reason"] = globals.reason;
    if (!globals.timeout.empty()) {
      params["deadline_ms"] =
          std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count();
    }
  }
  g_change_awaited = changes ? 1 : 0;
  auto answer =
      urgent ? call_urgently(method, params, timeout) : client_.call(method, params, timeout);
  g_change_awaited = 0;
  return answer;
}

std::variant<Json, Fault> Session::call_urgently(std::string_view method, const Json& params,
                                                 std::chrono::nanoseconds timeout) {
  const auto begin = std::chrono::steady_clock::now();
  std::optional<Fault> lost;  // the request was sent, and nobody knows what became of it
  while (true) {
    std::variant<Json, Fault> answer = Json();
    auto until = begin + timeout;
    if (auto fault = connected_ ? std::nullopt : connect(true)) {
      if (fault->code == protocol::kUnreachable) until = std::min(until, begin + kSocketIsBack);
      const bool again = fault->code == protocol::kUnreachable || fault->id == "too_many_clients";
      if (!again) return std::move(*fault);
      answer = std::move(*fault);
    } else {
      connected_ = urgent_ = true;
      answer = client_.call(method, params, until - std::chrono::steady_clock::now());
      const auto* failed = std::get_if<Fault>(&answer);
      if (failed == nullptr) return answer;
      const bool no_answer = failed->code == protocol::kUnreachable;
      if (no_answer && is_stop(method) && !globals.if_generation) {
        lost = *failed;
      } else if (no_answer || failed->id != "too_many_clients") {
        return answer;
      }
      connected_ = false;
    }
    if (std::chrono::steady_clock::now() + kBetweenTries >= until) {
      if (lost) return std::move(*lost);
      return answer;
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
}

void Session::print(const Json& value, std::string_view text) {
  if (screen.json) {
    screen.out << protocol::to_line(value) << '\n';
  } else {
    screen.out << text;
  }
  screen.out.flush();
}

int Session::fail(const Fault& fault) {
  if (screen.json) {
    screen.out << protocol::to_line(fault_json(fault)) << '\n';
  } else {
    Fault shown = fault;
    shown.where = as_typed(fault.where);
    screen.err << render_fault(asked(fault.where), shown, {screen.width_err, screen.colour_err});
  }
  screen.out.flush();
  return fault.exit;
}

std::string Session::as_typed(std::string_view where) const {
  std::string option = "--" + std::string(where);
  std::ranges::replace(option, '_', '-');
  for (const Argument& argument : command.arguments) {
    if (argument.name == option && arguments.has(argument.name)) return option;
  }
  return std::string(where);
}

std::string Session::asked(std::string_view where) const {
  std::string text(command.name);
  for (const Argument& argument : command.arguments) {
    if (argument.is_option()) continue;
    for (const std::string& given : arguments.all(argument.name)) {
      const std::string name = given.substr(0, given.find('='));
      if (!argument.many || name == where) return text + " " + name;
    }
  }
  return text;
}

}  // namespace mauve::ctl
