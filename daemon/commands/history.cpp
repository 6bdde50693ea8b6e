// SPDX-License-Identifier: LGPL-3.0-or-later
/// config.history: the saved generations. config.compare: what differs between two of them.
/// config.rollback: back to one of them.
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

Error nothing_kept(const Call& call) {
  return refuse(Errc::unsupported, std::string(call.method->name), "no generation is kept",
                "start mauved with --state-dir DIR");
}

void answer_compared(Running& running, const Call& call, Result<Json> judged) {
  if (!judged) {
    return answer(running, call, judged.error());
  }
  if (!(*judged)["errors"].empty()) {
    return refuse_text(running, call, "the later generation has",
                       "it was made with other plugin files than those of now",
                       std::move((*judged)["errors"]));
  }
  judged->erase("errors");
  answer(running, call, *std::move(judged));
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

/// Each generation is made and compared in a process of its own, so that a viewer may ask.
void compare_generations(Running& running, const CallPtr& call, Ticket /*none*/) {
  if (running.keeper == nullptr) {
    return answer(running, *call, nothing_kept(*call));
  }
  const auto from = call->params["from"].get<std::uint64_t>();
  const auto to = call->params["to"].get<std::uint64_t>();
  using Texts = std::pair<Result<std::string>, Result<std::string>>;
  auto texts = std::make_shared<Texts>("", "");
  running.control.in_factory(
      [&running, from, to, texts] {
        const auto& kept = running.keeper->generations();
        *texts = {kept.text(from), kept.text(to)};
      },
      [&running, call, texts] {
        for (const auto* text : {&texts->first, &texts->second}) {
          if (!*text) {
            return answer(running, *call, text->error());
          }
        }
        auto question = question_of(running, *call);
        question.running = *texts->first;
        question.text = *texts->second;
        running.judge(asker_of(*call), question, [&running, call](Result<Json> judged) {
          answer_compared(running, *call, std::move(judged));
        });
      },
      [&running, call](const std::string& hook) {
        answer(running, *call, given_up(running, hook, "config.compare"));
      });
}

void rollback(Running& running, const CallPtr& call, Ticket ticket) {
  if (running.keeper == nullptr) {
    return answer(running, *call, nothing_kept(*call));
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
