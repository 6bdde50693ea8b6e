// SPDX-License-Identifier: LGPL-3.0-or-later
/// One contract, as it stands in headers of different days: the definitions below say which.
#pragma once

#include <cstdint>
#include <string_view>
#include <tuple>

#include <mauve/plugin.h>

namespace line {

struct Shell : mauve::Shell {
#ifdef LINE_OTHER_PORTS
  mauve::WritePort<double> extra{*this, "extra"};
  mauve::WritePort<double> out{*this, "out"};
#else
  mauve::WritePort<double> out{*this, "out"};
  mauve::WritePort<double> extra{*this, "extra"};
#endif
};

/// Described, named or neither, as the build says. Both forms have one size.
struct Sum {
#ifdef LINE_OTHER_STATE
  double last = 0;
  std::int64_t count = 0;
#else
  std::int64_t count = 0;
  double last = 0;
#endif
};

class Core : public mauve::Core<Shell> {
 public:
  using Contract = Core;
  static constexpr const char* contract = "line/core/1";

#ifdef LINE_OTHER_FUNCTIONS
  virtual void prepare() {}
#endif
  virtual void update() = 0;

#ifdef LINE_OTHER_PROPERTIES
  mauve::Property<double> high{*this, "high", 2.0};
  mauve::Property<double> low{*this, "low", 1.0};
#else
  mauve::Property<double> low{*this, "low", 1.0};
  mauve::Property<double> high{*this, "high", 2.0};
#endif
};

struct Fsm : mauve::Fsm<Core> {
  Exec update{*this, "update", &Core::update};
  Sync period{*this, "period", std::chrono::milliseconds(10)};

  mauve::Status on_configure() override {
    start_at(update);
    update.then(period);
    period.then(update);
    return mauve::ok();
  }
};

}  // namespace line

#ifdef LINE_DESCRIBED
template <>
struct mauve::Described<line::Sum> {
  static constexpr std::string_view name = "line_sum/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("count", &line::Sum::count),
                      mauve::field("last", &line::Sum::last)};
  }
};
#endif
#ifdef LINE_VOUCHED
template <>
struct mauve::Described<line::Sum> {
  static constexpr std::string_view name = "line_sum/1";
#ifdef LINE_OPAQUE
  static constexpr auto fields() { return std::tuple{}; }
#endif
};
#endif
