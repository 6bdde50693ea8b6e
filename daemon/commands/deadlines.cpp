// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/deadlines.h"

#include "base/thread_role.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/mutex.h"
#include "commands/answer.h"

namespace mauve::daemon {

namespace {

std::string deadline_of(const Call& call) {
  return "its deadline of " + std::to_string(number_or(call.params, "deadline_ms", 0)) + " ms";
}

/// No part of the request takes effect after this answer.
bool expire(Call& call) {
  for (auto stage = call.stage->load(); stage == Stage::waiting || stage == Stage::preparing;) {
    if (call.stage->compare_exchange_weak(stage, Stage::expired)) {
      return true;
    }
  }
  return false;
}

void answer_late(const Running& running, Call& call) {
  const std::string method(call.method->name);
  const auto generation = running.generation.load();
  if (expire(call)) {
    return call.reply(protocol::fault_of(
        refuse({Errc::timed_out, "deadline_passed"}, method,
               deadline_of(call) +
                   " passed before the change could take effect, so the change is dropped",
               "the machine is busy, or a hook takes long: mauvectl status; then try again"),
        "unchanged", generation));
  }
  call.reply(protocol::fault_of(
      refuse({Errc::timed_out, "outcome_unknown"}, method,
             deadline_of(call) + " passed while the change was taking effect; its outcome is not "
                                 "known yet",
             "mauvectl history shows its generation once it is over"),
      "unknown", generation));
}

}  // namespace

bool advance_to(Stage next, std::atomic<Stage>& stage) {
  for (auto now = stage.load(); now != Stage::expired;) {
    if (stage.compare_exchange_weak(now, next)) {
      return true;
    }
  }
  return false;
}

void Deadlines::watch(const std::shared_ptr<Call>& call) {
  MAUVE_ON_THREAD(io);
  const auto allowed = deadline_in(call->params);
  if (!allowed) {
    return;
  }
  auto answered = std::make_shared<std::atomic<bool>>(false);
  call->reply = [answered, reply = std::move(call->reply)](server::Outcome outcome) {
    if (!answered->exchange(true)) {
      reply(std::move(outcome));
    }
  };
  const MutexLock lock(mutex_);
  watched_.push_back({call->received + *allowed, call});
}

void Deadlines::look(const Running& running, Time now) {
  MAUVE_ON_THREAD(health);
  std::vector<std::shared_ptr<Call>> late;
  {
    const MutexLock lock(mutex_);
    std::erase_if(watched_, [&](const Watched& one) {
      if (one.at >= now) {
        return one.call.expired();
      }
      if (auto call = one.call.lock()) {
        late.push_back(std::move(call));
      }
      return true;
    });
  }
  for (const auto& call : late) {
    answer_late(running, *call);
  }
}

}  // namespace mauve::daemon
