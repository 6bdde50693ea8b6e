// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/core.h>

#include <cstring>
#include <new>

namespace mauve {

StateBase::StateBase(CoreBase& owner, const DataType& type, std::shared_ptr<void> object)
    : type_(type), object_(std::move(object)) {
  owner.state_ = this;
}

void StateBase::keep_alive(std::shared_ptr<void> library) {
  if (type_.flat && type_.to_value != nullptr) {
    // Described plain bytes need no code, so that a reload can unmap the plugin they came from.
    const auto alignment = static_cast<std::align_val_t>(type_.alignment);
    const std::shared_ptr<void> plain(
        ::operator new(type_.size, alignment),
        [alignment](void* memory) { ::operator delete(memory, alignment); });
    std::memcpy(plain.get(), object_.get(), type_.size);
    object_ = plain;
    return;
  }
  // The object goes first, then the library whose code destroys it.
  struct Kept {
    std::shared_ptr<void> library;
    std::shared_ptr<void> object;
  };
  auto kept = std::make_shared<Kept>(Kept{std::move(library), object_});
  void* const address = object_.get();
  object_ = std::shared_ptr<void>(std::move(kept), address);
}

Stateless::Stateless(CoreBase& owner) { owner.stateless_ = true; }

}  // namespace mauve
