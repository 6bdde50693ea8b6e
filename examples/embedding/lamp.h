// SPDX-License-Identifier: LGPL-3.0-or-later
/// A lamp with two cores: one blinks, the other one shines steadily.
#pragma once

#include <mauve/element.h>

namespace lamp {

struct Shell : mauve::Shell {
  mauve::WritePort<double> lamp{*this, "lamp", mauve::Safe{0.0}};  // 0 to 1
};

/// The contract of both cores.
class Core : public mauve::Core<Shell> {
 public:
  using Contract = Core;
  static constexpr const char* contract = "lamp/core/1";

  mauve::Property<double> brightness{*this, "brightness", 0.5, "when on", {.min = 0.0, .max = 1.0}};
  mauve::State<int> jobs{*this};

  virtual void update() = 0;  // [rt] every period
};

class Blinking final : public Core {
  void update() override { shell().lamp.write(++*jobs % 2 == 0 ? 0.0 : brightness.get()); }
};

class Steady final : public Core {
  void update() override {
    ++*jobs;
    shell().lamp.write(brightness);
  }
};

}  // namespace lamp
