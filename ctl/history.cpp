// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "actions.h"
#include "words.h"

namespace mauve::ctl {

using protocol::fault_of;

int run_history(Session& session) {
  constexpr const char* kLines = "-n,--lines";
  Json params = Json::object();
  if (session.arguments.has(kLines)) {
    const auto count = count_of(session.arguments.one(kLines));
    if (!count) {
      return session.fail(
          fault_of(protocol::kUsage, "-n takes a count", session.arguments.one(kLines)));
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
