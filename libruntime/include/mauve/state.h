// SPDX-License-Identifier: LGPL-3.0-or-later
/// State: the data of a core that must survive a change.
#pragma once

#include <memory>
#include <string_view>

#include <mauve/detail/capsule.h>
#include <mauve/detail/declared.h>

namespace mauve {

class CoreBase;

/// The base class of states, through which the runtime uses them.
class StateBase : public Capsule {
 public:
  /// The hand-over: the two cores exchange their state objects. [rt], two pointer stores.
  void exchange(StateBase& other) { object_.swap(other.object_); }
  /// The hand-over from another type: the old object stays as it is. [rt], bounded.
  void convert(const StateBase& old, const ConvertsBase& by);
  /// The hand-over of plain bytes of the same type to which there may be a rollback: the old object
  /// stays as it is. [control]
  void copy(const StateBase& old);
  /// Runtime only: the state object keeps the library alive that made it; a described, trivially
  /// copyable one is moved to memory that needs no library.
  void keep_alive(std::shared_ptr<void> library);
  /// For people and tools, off the real-time threads and only while the core is not running.
  [[nodiscard]] const void* data() const { return object_.get(); }

 protected:
  /// Registers itself with the core.
  StateBase(CoreBase& owner, const DataType& type, std::shared_ptr<void> object);
  [[nodiscard]] void* object() const { return object_.get(); }  ///< owned by the state

 private:
  std::shared_ptr<void> object_;
};

/// The data of a core that must survive a change. Declared as a member, one for each core, used as
/// `state->goal` on the thread of the component [rt]. Cores that share the state type hand it over
/// in a swap; a core with another type declares a converter (converts.h). Describe T, so that its
/// layout is compared field by field. A state without description or name (type.h) is handed over
/// within one build of its plugin only; a change notes a state with a name alone. Do not keep
/// references into it: a swap exchanges the object. A change that would lose it is refused.
/// @snippet api_examples.cpp State
template <typename T>
class State final : public StateBase {
 public:
  /// A core to which nothing is handed over begins with `initial`.
  explicit State(CoreBase& owner, T initial = T{})
      : StateBase(owner, data_type<T>(), std::make_shared<T>(std::move(initial))) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<1, detail::Types<CoreBase&, T>, Wrong...>) explicit State(Wrong&&...)
      : State(detail::none<CoreBase&>(), detail::none<T>()) {
    static_assert(
        detail::kNever<Wrong...>,
        "mauve: a state is a member of a core, declared as `State<T> NAME{*this};` or with "
        "a first value of its type, `State<T> NAME{*this, T{...}};`");
  }

  T& operator*() { return *static_cast<T*>(object()); }                    ///< [rt]
  T* operator->() { return static_cast<T*>(object()); }                    ///< [rt]
  const T& operator*() const { return *static_cast<const T*>(object()); }  ///< [rt]
  const T* operator->() const { return static_cast<const T*>(object()); }  ///< [rt]
};

/// Declared as a member by a core that has nothing to hand over. A reaction to a fault may then
/// bring the core in place of one that has a state.
/// @snippet api_examples.cpp Stateless
class Stateless {
 public:
  explicit Stateless(CoreBase& owner);  ///< registers itself with the core
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<1, detail::Types<CoreBase&>, Wrong...>) explicit Stateless(Wrong&&...)
      : Stateless(detail::none<CoreBase&>()) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: Stateless is a member of a core, declared as `Stateless NAME{*this};`");
  }
};

}  // namespace mauve
