// SPDX-License-Identifier: LGPL-3.0-or-later
#include <cstdint>
#include <string>
#include <vector>

#include "commands/actions.h"
#include "render/words.h"

namespace mauve::ctl {

using protocol::wrong_use;

namespace {

int compare(Session& session, const std::vector<std::string>& generations) {
  std::vector<std::uint64_t> numbers;
  for (const std::string& text : generations) {
    const auto number = count_of(text);
    if (!number) {
      return session.fail(wrong_use("usage_not_a_generation", "'" + text + "' is not a generation",
                                    {}, "mauvectl history lists them"));
    }
    numbers.push_back(*number);
  }
  if (numbers.size() != 2) {
    return session.fail(wrong_use("usage_not_a_generation",
                                  "two generations are compared, not one or three", {},
                                  "example: mauvectl history 3 5"));
  }
  const auto answer = session.call("config.compare", {{"from", numbers[0]}, {"to", numbers[1]}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  session.print(result, render_compared(numbers[0], numbers[1], result, session.look()));
  return 0;
}

}  // namespace

int run_history(Session& session) {
  if (const auto two = session.arguments.all("GENERATION"); !two.empty()) {
    return compare(session, two);
  }
  constexpr const char* kLines = "-n,--lines";
  Json params = Json::object();
  if (session.arguments.has(kLines)) {
    const auto count = count_of(session.arguments.one(kLines));
    if (!count) {
      return session.fail(wrong_use("usage_not_a_count", "-n takes a count",
                                    session.arguments.one(kLines),
                                    "example: mauvectl history -n 5"));
    }
    params["n"] = *count;
  }
  const auto answer = session.call("config.history", params);
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  session.print(result, render_history(result, session.look()));
  return 0;
}

}  // namespace mauve::ctl
