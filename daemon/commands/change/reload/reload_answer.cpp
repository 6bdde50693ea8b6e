// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/reload/reload_answer.h"

#include <utility>
#include <variant>

namespace mauve::daemon {

void ReloadAnswer::receipt(server::Outcome outcome) {
  const MutexLock lock(mutex_);
  outcome_ = std::move(outcome);
  reply_when_whole();
}

void ReloadAnswer::old_code(plugin::Unmapped unmapped) {
  const MutexLock lock(mutex_);
  unmapped_ = std::move(unmapped);
  reply_when_whole();
}

void ReloadAnswer::reply_when_whole() {
  if (!outcome_ || !unmapped_) {
    return;
  }
  if (auto* result = std::get_if<protocol::Json>(&*outcome_)) {
    (*result)["unmapped"] = unmapped_->unmapped;
    (*result)["why"] = unmapped_->reason;
  }
  reply_(*std::move(outcome_));
}

}  // namespace mauve::daemon
