// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/trial.h"

#include "base/thread_role.h"

#include <utility>

#include "arch/parse/spec.h"
#include "commands/answer.h"

namespace mauve::daemon {

void try_out(Running& running, const CallPtr& call, const Question& question, const std::string& at,
             std::function<void()> then) {
  MAUVE_ON_THREAD(control);
  running.judge_change(question, [&running, call, at, then = std::move(then)](Result<Json> made) {
    if (made) {
      return then();
    }
    if (made.error().at == kWholeFile) {
      made.error().at = at;
    }
    answer(running, *call, made.error());
  });
}

Question question_of_plugin(const std::string& name) {
  const Json file{{"schema", arch::kSchema}, {"name", "trial"}, {"plugins", {name}}};
  Question question{file.dump()};
  question.loads = true;
  return question;
}

}  // namespace mauve::daemon
