// SPDX-License-Identifier: LGPL-3.0-or-later
/// The runtime without the daemon: an architecture in code, configured, refused, run and changed.
#include <cstdio>
#include <string>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "blink.h"

namespace {

struct Lighthouse : mauve::Architecture {
  mauve::SharedData<double> lamp{*this, "lamp", 0.0};
  mauve::Component<blink::Shell, blink::Core, mauve::PeriodicFsm<blink::Core>> blinker{*this,
                                                                                       "blinker"};
  double brightness = 0.5;

  mauve::Status on_configure() override {
    if (mauve::Status done = blinker.shell().lamp.connect(lamp.write_service()); !done) return done;
    blinker.core().brightness = brightness;
    return mauve::ok();
  }
};

int failures = 0;

void expect(bool truth, const char* what) {
  std::printf("%s %s\n", truth ? "ok  " : "FAIL", what);
  if (!truth) ++failures;
}

void configures_and_refuses() {
  Lighthouse good;
  const mauve::Status configured = good.configure();
  if (!configured) std::printf("%s\n", to_string(configured.error()).c_str());
  expect(configured.has_value() && good.configured(), "an architecture configures");
  expect(good.find_component("blinker") == &good.blinker, "a component is found by name");
  expect(good.cleanup().has_value() && !good.configured(), "it is cleaned up");

  Lighthouse bad;
  bad.brightness = 1.5;
  const mauve::Status refused = bad.configure();
  expect(!refused && !bad.configured(), "a value out of range is refused");
  expect(!refused && refused.error().at == "blinker.core.brightness", "the refusal says where");
}

void runs_and_changes_while_it_runs() {
  using namespace std::chrono_literals;
  Lighthouse lighthouse;
  mauve::Deployer deployer(lighthouse, {.realtime = mauve::Realtime::off, .simulated = true});
  expect(deployer.deploy().has_value(), "it deploys");

  deployer.run_for(95ms);
  expect(deployer.status("blinker").releases == 10, "ten releases in 95 ms at 10 ms");

  const auto receipt = deployer.set("blinker.core.brightness", mauve::Value(0.9));
  expect(receipt.has_value(), "a property changes on the running component");
  deployer.run_for(100ms);
  expect(deployer.status("blinker").releases == 20, "and no release is missed");
  expect(deployer.status("blinker").missed == 0, "by count");
  expect(deployer.shutdown().empty(), "it shuts down");
}

}  // namespace

int main() {
  configures_and_refuses();
  runs_and_changes_while_it_runs();
  return failures == 0 ? 0 : 1;
}
