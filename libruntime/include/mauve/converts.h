// SPDX-License-Identifier: LGPL-3.0-or-later
/// Converts: how a core takes over the state of another revision.
///
///   mauve::State<Guidance> state{*this};
///   mauve::Converts<GuidanceV1, Guidance> from_v1{
///       state, [](const GuidanceV1& old, Guidance& now) noexcept { now.goal = old.target; }};
///
/// GuidanceV1 is the old struct with its old description ("guidance/1"), kept beside the new one.
/// Several may stand there, one for each type. The old object stays as it was: a core that comes
/// back goes on from the value it had, unless it has a converter of its own for the rollback.
#pragma once

#include <cstddef>
#include <type_traits>

#include <mauve/slow_state.h>
#include <mauve/state.h>

namespace mauve {

/// The largest object that is converted at a boundary, bytes. To copy so much into another layout
/// takes under 300 ns; the computation of the converter comes on top, in the component's own time.
inline constexpr std::size_t kMaxConverted = 4096;

/// The base class of converters, through which the runtime uses them.
class ConvertsBase {
 public:
  ConvertsBase(const ConvertsBase&) = delete;
  ConvertsBase& operator=(const ConvertsBase&) = delete;
  virtual ~ConvertsBase() = default;

  [[nodiscard]] const DataType& from() const { return from_; }  ///< the type that it converts
  /// Converts a state [rt], or a slow state [factory].
  virtual void run(const void* old, void* now) const = 0;

 protected:
  /// Registers itself with the state.
  ConvertsBase(Capsule& into, const DataType& from) : from_(from) {
    into.converters_.push_back(this);
  }

 private:
  const DataType& from_;
};

/// Declared as a member of the new core, after its state.
/// @snippet api_examples.cpp Converts
template <typename Old, typename Now>
class Converts final : public ConvertsBase {
 public:
  /// The converter of a state runs at the boundary, on the component's thread: [rt], bounded, and
  /// only on plain bytes. `now` is as the new core's configure left it.
  Converts(State<Now>& into, void (*convert)(const Old& old, Now& now) noexcept)
      : ConvertsBase(into, data_type<Old>()), convert_(convert) {
    static_assert(sizeof(Old) <= kMaxConverted && sizeof(Now) <= kMaxConverted,
                  "mauve: too large to be converted at a boundary: put the bulk into a SlowState");
    static_assert(std::is_trivially_copyable_v<Old> && std::is_trivially_copyable_v<Now>,
                  "mauve: converted at a boundary, where nothing may allocate: plain bytes only");
  }
  /// The converter of a slow state runs beside the system. [factory], may take its time and throw.
  Converts(SlowState<Now>& into, void (*convert)(const Old& old, Now& now))
      : ConvertsBase(into, data_type<Old>()), convert_(convert) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<2, detail::Types<State<Now>&, void (*)(const Old&, Now&) noexcept>,
                              Wrong...> &&
           !detail::kDeclares<2, detail::Types<SlowState<Now>&, void (*)(const Old&, Now&)>,
                              Wrong...>) explicit Converts(Wrong&&...)
      : Converts(detail::none<SlowState<Now>&>(), nullptr) {
    static_assert(
        detail::kNever<Wrong...>,
        "mauve: a converter is declared after its state as `Converts<Old, Now> NAME{STATE, "
        "[](const Old& old, Now& now) noexcept { ... }};` and captures nothing");
  }

  void run(const void* old, void* now) const override {
    convert_(*static_cast<const Old*>(old), *static_cast<Now*>(now));
  }

 private:
  void (*convert_)(const Old& old, Now& now);
};

}  // namespace mauve
