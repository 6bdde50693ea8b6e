// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/core.h>

#include <cstring>
#include <new>

#include <mauve/converts.h>
#include <mauve/job.h>

namespace mauve {
namespace {

/// The object goes first, then the library whose code destroys it.
std::shared_ptr<void> with_library(std::shared_ptr<void> library, std::shared_ptr<void> object) {
  struct Kept {
    std::shared_ptr<void> library;
    std::shared_ptr<void> object;
  };
  void* const address = object.get();
  auto kept = std::make_shared<Kept>(Kept{std::move(library), std::move(object)});
  return {std::move(kept), address};
}

}  // namespace

const ConvertsBase* Capsule::converter_from(const DataType& other) const {
  for (const ConvertsBase* known : converters_) {
    if (same_type(known->from(), other)) return known;
  }
  return nullptr;
}

StateBase::StateBase(CoreBase& owner, const DataType& type, std::shared_ptr<void> object)
    : Capsule(type), object_(std::move(object)) {
  owner.state_ = this;
}

void StateBase::convert(const StateBase& old, const ConvertsBase& by) {
  by.run(old.data(), object_.get());
}

void StateBase::copy(const StateBase& old) { std::memcpy(object_.get(), old.data(), type().size); }

void StateBase::keep_alive(std::shared_ptr<void> library) {
  if (type().flat && type().to_value != nullptr) {
    // Described plain bytes need no code, so that a reload can unmap the plugin they came from.
    const auto alignment = static_cast<std::align_val_t>(type().alignment);
    const std::shared_ptr<void> plain(
        ::operator new(type().size, alignment),
        [alignment](void* memory) { ::operator delete(memory, alignment); });
    std::memcpy(plain.get(), object_.get(), type().size);
    object_ = plain;
    return;
  }
  object_ = with_library(std::move(library), std::move(object_));
}

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

Stateless::Stateless(CoreBase& owner) { owner.stateless_ = true; }

}  // namespace mauve
