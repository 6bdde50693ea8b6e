// SPDX-License-Identifier: LGPL-3.0-or-later
/// SlowState: data of a core that is large or slow to make, and constant while the core runs: a
/// map, a table, a trained model.
///
///   mauve::SlowState<Map> map{*this};
///
///   mauve::Status on_configure() override {
///     return map && map->file == file.get() ? mauve::ok() : map.set(load(file));
///   }
///
/// The next core shares the same object, or converts it (converts.h), before it is configured and
/// while this one still runs; the boundary has nothing to do. Data that a job changes belongs in a
/// State, which may be of any size: its object is moved, never copied.
#pragma once

#include <memory>
#include <utility>

#include <mauve/detail/capsule.h>
#include <mauve/detail/declared.h>
#include <mauve/result.h>

namespace mauve {

class CoreBase;

/// The base class of slow states, through which the runtime uses them. [factory], but for reading
/// it.
class SlowStateBase : public Capsule {
 public:
  /// A state was set, or adopted from the core before. [any]
  [[nodiscard]] explicit operator bool() const { return object_ != nullptr; }

  /// Runtime only: the hand-over. The other may be running with its object meanwhile.
  void share(const SlowStateBase& old) { object_ = old.object_; }
  void convert(const SlowStateBase& old, const ConvertsBase& by);  ///< the same from another type
  /// Runtime only: the objects made from now on keep the library alive that makes them.
  void keep_alive(std::shared_ptr<void> library) { library_ = std::move(library); }

 protected:
  SlowStateBase(CoreBase& owner, const DataType& type);  ///< registers itself with the core
  [[nodiscard]] const void* object() const { return object_.get(); }  ///< null: nothing was set
  Status replace(std::shared_ptr<void> object);                       ///< refused in a job

 private:
  [[nodiscard]] virtual std::shared_ptr<void> make() const = 0;

  CoreBase& owner_;
  std::shared_ptr<void> library_;
  std::shared_ptr<const void> object_;  ///< immutable: shared with the cores before and after
};

/// Large data that is constant while its core runs. Declared as a member. It is shared with the
/// next core, never copied; the last core that holds it frees it. [factory] sets it, [rt] reads it.
/// @snippet api_examples.cpp SlowState
template <typename T>
class SlowState final : public SlowStateBase {
 public:
  /// Holds nothing yet.
  explicit SlowState(CoreBase& owner) : SlowStateBase(owner, data_type<T>()) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<1, detail::Types<CoreBase&>, Wrong...>) explicit SlowState(Wrong&&...)
      : SlowState(detail::none<CoreBase&>()) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: a slow state is a member of a core, declared as `SlowState<T> "
                  "NAME{*this};`; on_configure() gives it its value with set()");
  }

  /// Only when there is one. [any]
  const T& operator*() const { return *static_cast<const T*>(object()); }
  /// Only when there is one [any]
  const T* operator->() const { return static_cast<const T*>(object()); }

  /// In on_configure(); refused in a job. Cores before this one keep theirs. [factory]
  Status set(T value) { return replace(std::make_shared<T>(std::move(value))); }

 private:
  [[nodiscard]] std::shared_ptr<void> make() const override { return std::make_shared<T>(); }
};

}  // namespace mauve
