// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/slow_state.h>

#include <memory>
#include <utility>

#include "model/element/with_library.h"

#include <mauve/converts.h>
#include <mauve/core.h>
#include <mauve/detail/job.h>

namespace mauve {

SlowStateBase::SlowStateBase(CoreBase& owner, const DataType& type) : Capsule(type), owner_(owner) {
  owner.slow_state_ = this;
}

void SlowStateBase::convert(const SlowStateBase& old, const ConvertsBase& by) {
  if (old.object_ == nullptr) return;
  std::shared_ptr<void> made = make();
  by.run(old.object_.get(), made.get());
  object_ = with_library(library_, std::move(made));
}

Status SlowStateBase::replace(std::shared_ptr<void> object) {
  if (Status outside = refuse_in_job(owner_.address(), "SlowState::set()"); !outside) {
    return outside;
  }
  object_ = with_library(library_, std::move(object));
  return ok();
}

}  // namespace mauve
