// SPDX-License-Identifier: LGPL-3.0-or-later
/// The runtime without the daemon: an architecture in code, configured, refused and configured
/// again.
#include <cstdio>
#include <string>

#include <mauve/architecture.h>

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

}  // namespace

int main() {
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
  return failures == 0 ? 0 : 1;
}
