// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/state.h>

#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "model/element/with_library.h"

#include <mauve/converts.h>
#include <mauve/core.h>

namespace mauve {

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

Stateless::Stateless(CoreBase& owner) { owner.stateless_ = true; }

}  // namespace mauve
