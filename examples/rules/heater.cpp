// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "heater/heater" with two cores: "heater/regulator" regulates the temperature, and
/// "heater/off" switches the heater off.
#include <algorithm>
#include <stdexcept>

#include <mauve/plugin.h>

namespace heater {

struct Shell : mauve::Shell {
  mauve::ReadPort<double> temperature{*this, "temperature", 20.0};   // degrees Celsius
  mauve::WritePort<double> power{*this, "power", mauve::Safe{0.0}};  // W
};

/// The contract of both cores.
class Core : public mauve::Core<Shell> {
 public:
  using Contract = Core;
  static constexpr const char* contract = "heater/core/1";

  mauve::Observable<double> power{*this, "power", 0.0, "of the heater", "W"};
  mauve::Stateless stateless{*this};

  /// [rt] every period
  void update() {
    power = wanted_power(shell().temperature.read());
    shell().power.write(power);
  }

 protected:
  virtual double wanted_power(double temperature) = 0;
};

class Regulator final : public Core {
  mauve::Property<double> target{*this, "target", 60.0, "of the temperature", {.unit = "degC"}};
  mauve::Property<double> gain{*this, "gain", 50.0, "power for each degree", {.unit = "W/K"}};

  double wanted_power(double temperature) override {
    // A defect that a test of the plugin did not find: the core fails with a broken sensor.
    if (temperature < -50.0) throw std::runtime_error("the sensor is broken");
    return std::clamp(gain * (target - temperature), 0.0, 2000.0);
  }
};

/// Simple enough to stand by for any core of the contract.
class Off final : public Core {
  double wanted_power(double /*temperature*/) override { return 0.0; }
};

}  // namespace heater

MAUVE_PLUGIN(plugin) {
  plugin.core<heater::Regulator>("regulator");
  plugin.core<heater::Off>("off");
  plugin.component<heater::Shell, mauve::PeriodicFsm<heater::Core>>("heater", "regulator");
}
