// SPDX-License-Identifier: LGPL-3.0-or-later
/// config.history: the saved generations. config.rollback: back to one of them.
#include <memory>
#include <optional>
#include <utility>

#include "commands/answer.h"
#include "commands/architecture.h"
#include "commands/given_up.h"
#include "keeper.h"

namespace mauve::daemon {

namespace {

Json row(const Generation& one) {
  Json row = {{"generation", one.number}};
  if (one.damaged) {
    row["mark"] = "damaged";
    return row;
  }
  row.update({{"boot", one.boot},
              {"time", one.time},
              {"uid", one.uid},
              {"command", one.command},
              {"reason", one.reason},
              {"changes", one.changes},
              {"mark", to_string(one.mark)}});
  return row;
}

Error nothing_kept() {
  return refuse(Errc::unsupported, "config.rollback", "no generation is kept",
                "start mauved with --state-dir DIR");
}

}  // namespace

Result<Json> history(Running& running, const Call& call) {
  Json items = Json::array();
  if (running.keeper == nullptr) {
    return Json{{"items", std::move(items)}, {"state_dir", nullptr}};
  }
  const auto all = running.keeper->generations().list();
  const auto wanted = number_or(call.params, "n", all.size());
  for (const auto& one : all) {
    if (items.size() >= wanted) {
      break;
    }
    items.push_back(row(one));
  }
  return Json{{"items", std::move(items)}, {"state_dir", running.keeper->directory()}};
}

void rollback(Running& running, const CallPtr& call, Ticket ticket) {
  if (running.keeper == nullptr) {
    return answer(running, *call, nothing_kept());
  }
  const auto number = call->params["generation"].get<std::uint64_t>();
  auto text = std::make_shared<std::optional<Result<std::string>>>();
  running.control.in_factory(
      [&running, number, text] { *text = running.keeper->generations().text(number); },
      [&running, call, number, text, ticket = std::move(ticket)]() mutable {
        if (!**text) {
          return answer(running, *call, (*text)->error());
        }
        apply_architecture(running, call, std::move(ticket), ***std::move(text),
                           "rollback to generation " + std::to_string(number));
      },
      [&running, call](const std::string& hook) {
        answer(running, *call, given_up(running, hook, "config.rollback"));
      });
}

}  // namespace mauve::daemon
