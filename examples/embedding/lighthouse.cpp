// SPDX-License-Identifier: LGPL-3.0-or-later
/// A program that contains mauve: it builds an architecture in code, runs it on real-time threads,
/// and changes it while it runs. It needs neither mauved nor a file.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "lamp.h"

namespace {

struct Lighthouse : mauve::Architecture {
  mauve::SharedData<double> light{*this, "light", 0.0};
  mauve::Component<lamp::Shell, lamp::Blinking, mauve::PeriodicFsm<lamp::Core>> keeper{*this,
                                                                                       "keeper"};
  double brightness = 0.5;

  /// Connections and properties. configure() reports an error of any of them, with its address.
  mauve::Status on_configure() override {
    keeper.shell().lamp.connect(light.write_service());
    keeper.core().brightness = brightness;
    keeper.fsm().period = 5ms;
    keeper.task().priority = 20;
    return mauve::ok();
  }
};

/// Prints an error and ends the program; `done` is a Status or a Result.
template <typename Done>
void must(const char* step, const Done& done) {
  if (!done) {
    std::printf("%s: refused: %s\n", step, to_string(done.error()).c_str());
    std::exit(1);
  }
  std::printf("%s: done\n", step);
}

/// The host calls tend() some times a second: it ends probations and carries out rollbacks.
void run_until(mauve::Deployer& deployer, std::uint64_t releases) {
  while (deployer.status("keeper").releases < releases) {
    mauve::Retired retired;  // cleans up what is no longer in force
    for (const mauve::Outcome& outcome : deployer.tend(retired)) {
      std::printf("%s: %s\n", std::string(to_string(outcome.kind)).c_str(), outcome.reason.c_str());
    }
    std::this_thread::sleep_for(20ms);
  }
}

}  // namespace

int main() {
  Lighthouse wrong;
  wrong.brightness = 1.5;
  std::printf("a wrong value: %s\n", to_string(wrong.configure().error()).c_str());

  Lighthouse lighthouse;
  // Realtime::prefer: SCHED_FIFO where the process may use it, otherwise ordinary threads.
  mauve::Deployer deployer(lighthouse, {.realtime = mauve::Realtime::prefer});
  must("deploy", deployer.deploy());
  run_until(deployer, 10);

  must("set a property", deployer.set("keeper.core.brightness", mauve::Value(0.9)));
  const mauve::Result<mauve::Receipt> swapped = deployer.swap_core<lamp::Steady>("keeper");
  must("replace the core", swapped);
  run_until(deployer, 20);

  std::printf("generation %llu, core %s, %d states lost\n",
              static_cast<unsigned long long>(deployer.generation()),
              deployer.status("keeper").core.c_str(),
              static_cast<int>(swapped->components.front().dropped_bytes));
  // Every output gets its safe value. The names of components that did not end are returned.
  std::printf("shutdown: %zu components hang\n", deployer.shutdown().size());
}
