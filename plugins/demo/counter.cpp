// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "demo". Component kind "demo/counter": the smallest component that does something you can
/// see. Cores "demo/counter" (counts up) and "demo/countdown" (counts down) replace one another:
///   mauvectl watch counter.core.count
///   mauvectl swap-core counter demo/countdown --set step=2
#include <cstdint>

#include <mauve/plugin.h>

namespace demo {

/// The state that the cores hand over: the count goes on where the other core left it.
struct Count {
  std::int64_t value = 0;

  static constexpr std::string_view type_name = "demo_count/1";
  static constexpr auto fields() { return std::tuple{mauve::field("value", &Count::value)}; }
};

namespace {

/// The contract of both cores.
class CountingCore : public mauve::Core<mauve::EmptyShell> {
 public:
  using Contract = CountingCore;
  static constexpr const char* contract = "demo/counting/1";

  virtual void update() = 0;  // [rt] every period

 protected:
  mauve::State<Count> state{*this};
  mauve::Property<std::int64_t> step{
      *this, "step", 1, "added or subtracted each time", {.min = 0, .max = 1'000'000}};
  mauve::Observable<std::int64_t> count{*this, "count", 0, "where it stands"};
};

class Counter final : public CountingCore {
  void update() override { count = state->value += step; }
};

class Countdown final : public CountingCore {
  void update() override { count = state->value -= step; }
};

}  // namespace
}  // namespace demo

MAUVE_PLUGIN(plugin) {
  plugin.core<demo::Countdown>("countdown");
  plugin.core<demo::Counter>("counter");
  plugin.component<mauve::EmptyShell, mauve::PeriodicFsm<demo::CountingCore>>("counter", "counter");
}
