// SPDX-License-Identifier: LGPL-3.0-or-later
/// Services that a client uses, and conditions that it waits for.
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "commands/actions.h"
#include "protocol/framing.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::Exit;
using protocol::fault_of;

constexpr std::chrono::milliseconds kAskEvery{50};

std::string render_use(std::string_view done, const Json& result, Look look) {
  std::string text = std::string(done) + " " + word(result, "service");
  if (result.contains("result")) text += " = " + harmless(compact(member(result, "result")));
  text += "\n";
  std::string users;
  for (const Json& user : list_in(result, "users")) join(users, harmless(compact(user)));
  if (!users.empty() && word(result, "kind") == "write") {
    const std::string line =
        "note: " + users + " writes to it too: its next value replaces this one";
    text += painted(wrapped(line, look.width, 2), Paint::yellow, look.colour) + "\n";
  }
  return text;
}

int use(Session& session, std::string_view argument, std::string_view done) {
  Json arguments = Json::array();
  for (const auto& text : session.arguments.all(argument)) {
    auto parsed = protocol::parse_json(text);
    arguments.push_back(parsed ? std::move(*parsed) : Json(text));
  }
  const auto answer = session.call("service.call", {{"service", session.arguments.one("SERVICE")},
                                                    {"arguments", std::move(arguments)}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  session.print(result, render_use(done, result, session.look()));
  return 0;
}

std::string values_of(const Json& result) {
  std::string text;
  for (const Json& one : list_in(result, "values")) {
    join(text, word(one, "address") + " is " + word(one, "value"));
  }
  return text;
}

}  // namespace

int run_call(Session& session) { return use(session, "ARGUMENT", "called"); }
int run_write(Session& session) { return use(session, "VALUE", "wrote"); }

int run_wait(Session& session) {
  using Clock = std::chrono::steady_clock;
  const auto limit = timeout_of(session.globals.timeout);
  const auto begin = Clock::now();
  while (true) {
    const auto answer =
        session.call("condition.get", {{"condition", session.arguments.one("--for")}});
    if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
    const auto& result = std::get<Json>(answer);
    if (member(result, "holds") == true) {
      session.print(result, "it holds: " + values_of(result) + "\n");
      return 0;
    }
    if (limit && Clock::now() - begin >= *limit) {
      session.print(result, "it does not hold: " + values_of(result) + "\n");
      return static_cast<int>(Exit::condition);
    }
    std::this_thread::sleep_for(kAskEvery);
  }
}

}  // namespace mauve::ctl
