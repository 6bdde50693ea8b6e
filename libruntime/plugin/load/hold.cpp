// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/hold.h"

#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/mutex.h"
#include "mauve/fsm.h"
#include "mauve/slow_state.h"
#include "mauve/state.h"

namespace mauve::plugin {

Hold::Hold(std::shared_ptr<Library> library, std::string user) : library_(std::move(library)) {
  const MutexLock lock(library_->mutex_);
  user_ = library_->users_.insert(library_->users_.end(), {{}, std::move(user)});
}

Hold::~Hold() {
  const MutexLock lock(library_->mutex_);
  library_->users_.erase(user_);
}

void Hold::place(const std::string& address) {
  const MutexLock lock(library_->mutex_);
  user_->address = address;
}

namespace {

/// Deleter of an object made by a plugin: first the object, then the right to its code.
template <typename Base>
struct Release {
  std::shared_ptr<Hold> hold;
  std::shared_ptr<Base> object;

  void operator()(Base* /*same as object*/) {
    object.reset();
    hold.reset();
  }
};

template <typename Base>
std::shared_ptr<Base> made(const std::shared_ptr<Library>& library, std::shared_ptr<Base> object,
                           const std::string& name) {
  auto hold = std::make_shared<Hold>(library, name);
  // The list owns a copy of the address: the element may go while a thread reads the list. The
  // element is destroyed before its hold (Release), so a bare pointer does.
  object->when_adopted([held = hold.get()](const std::string& address) { held->place(address); });
  if constexpr (std::is_same_v<Base, CoreBase>) {
    if (StateBase* state = object->declared_state()) {
      state->keep_alive(std::make_shared<Hold>(library, "state " + state->type().name));
    }
    if (SlowStateBase* state = object->declared_slow_state()) {
      state->keep_alive(std::make_shared<Hold>(library, "state " + state->type().name));
    }
  }
  Base* raw = object.get();
  return std::shared_ptr<Base>(raw, Release<Base>{std::move(hold), std::move(object)});
}

template <typename Base>
detail::Make<Base> keep_made(const std::shared_ptr<Library>& library,
                             const detail::Make<Base>& plain, const std::string& name) {
  return [weak = std::weak_ptr<Library>(library), plain = &plain, name] {
    const std::shared_ptr<Library> mapped = weak.lock();
    if (!mapped || mapped->retired()) {
      throw std::runtime_error("the plugin of " + name + " was unloaded or reloaded meanwhile");
    }
    return made(mapped, (*plain)(), name);
  };
}

}  // namespace

detail::Make<Shell> keep(const std::shared_ptr<Library>& library, const detail::Make<Shell>& plain,
                         const std::string& name) {
  return keep_made(library, plain, name);
}

detail::Make<CoreBase> keep(const std::shared_ptr<Library>& library,
                            const detail::Make<CoreBase>& plain, const std::string& name) {
  return keep_made(library, plain, name);
}

detail::Make<FsmBase> keep(const std::shared_ptr<Library>& library,
                           const detail::Make<FsmBase>& plain, const std::string& name) {
  return keep_made(library, plain, name);
}

detail::Make<InterfaceBase> keep(const std::shared_ptr<Library>& library,
                                 const detail::Make<InterfaceBase>& plain,
                                 const std::string& name) {
  return keep_made(library, plain, name);
}

std::string user_of_type(const std::string& type) { return "data type " + type; }

std::shared_ptr<const DataType> keep(const std::shared_ptr<Library>& library,
                                     const DataType& type) {
  return {std::make_shared<Hold>(library, user_of_type(type.name)), &type};
}

}  // namespace mauve::plugin
