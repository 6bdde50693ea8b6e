// SPDX-License-Identifier: LGPL-3.0-or-later
/// config.history: the saved generations. config.compare: the differences between two of them.
/// config.rollback: back to one of them.
#include <memory>
#include <optional>
#include <utility>

#include "commands/answer.h"
#include "commands/change/architecture.h"
#include "commands/recovery/abandoned.h"
#include "judge/judge.h"
#include "state/compare_texts.h"
#include "state/state_store.h"

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
              {"builds", one.builds},
              {"mark", to_string(one.mark)}});
  if (!one.command.empty()) {
    row.update({{"uid", one.uid},
                {"command", one.command},
                {"reason", one.reason},
                {"changes", one.changes}});
  }
  return row;
}

Error nothing_kept(const Call& call) {
  return refuse({Errc::unsupported, "no_generation_kept"}, std::string(call.method->name),
                "no generation is kept", "start mauved with --state-dir DIR");
}

/// Two saved generations, of which the files are read.
struct Compared {
  std::uint64_t from = 0;
  std::uint64_t to = 0;
  Result<std::string> before = std::string();
  Result<std::string> after = std::string();
  Json lines;  ///< of the comparison by text
};

/// Files alone, when the plugin files of now cannot make one of the generations.
void answer_by_text(Running& running, const CallPtr& call, const std::shared_ptr<Compared>& two,
                    const std::string& why) {
  running.control.in_factory(
      [two] { two->lines = compare_texts(*two->before, *two->after); },
      [&running, call, two, why] {
        Json result{{"same", two->lines.empty()}, {"lines", two->lines}, {"by_text", why}};
        answer(running, *call, std::move(result));
      },
      [&running, call](const std::string& hook) {
        answer(running, *call, thread_abandoned(running, hook, "config.compare"));
      });
}

std::string not_made(std::uint64_t generation, const std::string& at, const std::string& why) {
  return "generation " + std::to_string(generation) +
         " cannot be made from the plugin files of now (" + at + ": " + why + ")";
}

void answer_compared(Running& running, const CallPtr& call, const std::shared_ptr<Compared>& two,
                     Result<Json> judged) {
  if (!judged) {
    const bool plugin_changed = judged.error().code == Errc::wrong_state || died(judged.error());
    if (!plugin_changed) {
      return answer(running, *call, judged.error());
    }
    return answer_by_text(running, call, two,
                          not_made(two->from, judged.error().at, judged.error().message));
  }
  if (const auto& errors = (*judged)["errors"]; !errors.empty()) {
    return answer_by_text(running, call, two,
                          not_made(two->to, errors[0]["at"], errors[0]["message"]));
  }
  judged->erase("errors");
  answer(running, *call, *std::move(judged));
}

}  // namespace

Result<Json> history(Running& running, const Call& call) {
  Json items = Json::array();
  if (running.store == nullptr) {
    return Json{{"items", std::move(items)}, {"state_dir", nullptr}};
  }
  const auto all = running.store->generations().list();
  const auto wanted = number_or(call.params, "n", all.size());
  for (const auto& one : all) {
    if (items.size() >= wanted) {
      break;
    }
    items.push_back(row(one));
  }
  return Json{{"items", std::move(items)}, {"state_dir", running.store->directory()}};
}

/// Each generation is made and compared in a process of its own, so that a viewer may ask.
void compare_generations(Running& running, const CallPtr& call, Ticket /*none*/) {
  if (running.store == nullptr) {
    return answer(running, *call, nothing_kept(*call));
  }
  auto two = std::make_shared<Compared>();
  two->from = call->params["from"].get<std::uint64_t>();
  two->to = call->params["to"].get<std::uint64_t>();
  running.control.in_factory(
      [&running, two] {
        const auto& kept = running.store->generations();
        two->before = kept.text(two->from);
        two->after = kept.text(two->to);
      },
      [&running, call, two] {
        for (const auto* text : {&two->before, &two->after}) {
          if (!*text) {
            return answer(running, *call, text->error());
          }
        }
        auto question = question_of(running, *call);
        question.running = *two->before;
        question.text = *two->after;
        running.judge(asker_of(*call), question, [&running, call, two](Result<Json> judged) {
          answer_compared(running, call, two, std::move(judged));
        });
      },
      [&running, call](const std::string& hook) {
        answer(running, *call, thread_abandoned(running, hook, "config.compare"));
      });
}

void rollback(Running& running, const CallPtr& call, Ticket ticket) {
  if (running.store == nullptr) {
    return answer(running, *call, nothing_kept(*call));
  }
  const auto number = call->params["generation"].get<std::uint64_t>();
  auto text = std::make_shared<std::optional<Result<std::string>>>();
  running.control.in_factory(
      [&running, number, text] { *text = running.store->generations().text(number); },
      [&running, call, number, text, ticket = std::move(ticket)]() mutable {
        if (!**text) {
          return answer(running, *call, (*text)->error());
        }
        apply_architecture(running, call, std::move(ticket), ***std::move(text),
                           running.store->generations().find(number));
      },
      [&running, call](const std::string& hook) {
        answer(running, *call, thread_abandoned(running, hook, "config.rollback"));
      });
}

}  // namespace mauve::daemon
