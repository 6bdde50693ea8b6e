// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "guidance_faulty": cores that go wrong half a second after they take over, to show the
/// recovery of the rover:
///   `mauvectl load guidance_faulty`
///   `mauvectl swap-core control guidance_faulty/throwing`                  rolled back by itself
///   `mauvectl swap-core control guidance_faulty/endless --probation off`   its fallback core takes
///                                                                          over
///   `mauvectl swap-core control guidance_faulty/slow`                      uses 5 ms a job, and is
///                                                                          rolled back
#include <chrono>
#include <cstdint>
#include <stdexcept>

#include "control.h"

namespace guidance {
namespace {

/// Drives on for so many jobs, slowly.
class Faulty : public GuidanceCore {
 protected:
  mauve::Property<std::int64_t> jobs{*this, "jobs", 50, "sound ones before the fault", {.min = 0}};

 private:
  virtual void go_wrong() = 0;

  Velocity steer(const Pose2D& /*pose*/, const Obstacles& /*obstacles*/, double /*dt*/) override {
    if (++done_ > jobs) go_wrong();
    Velocity slow;
    slow.linear = 0.1;
    return slow;
  }

  std::int64_t done_ = 0;
};

class Throwing final : public Faulty {
  void go_wrong() override { throw std::runtime_error("no way found"); }
};

class Endless final : public Faulty {
  void go_wrong() override {
    for (volatile bool looking = true; looking;) {
    }
  }
};

/// Comes to an end, but late.
class Slow final : public Faulty {
  void go_wrong() override {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(5);
    while (std::chrono::steady_clock::now() < end) {
    }
  }
};

}  // namespace
}  // namespace guidance

MAUVE_PLUGIN(plugin) {
  plugin.core<guidance::Throwing>("throwing");
  plugin.core<guidance::Endless>("endless");
  plugin.core<guidance::Slow>("slow");
}
