// SPDX-License-Identifier: LGPL-3.0-or-later
/// A player of a type of this project plays a recording: each value at its time.
#include <mauve-plugins/drivers/recording/playback.h>
#include <mauve/test_kit.h>

#include <cstdio>
#include <fstream>

#include "blink.h"

int main() {
  std::ofstream("lit.csv") << "time_s,lamp.read.on\n1.0,false\n1.5,true\n";
  mauve::CoreBench<drivers::PlaybackShell<blink::Lit>, drivers::Playback<blink::Lit>> bench;
  if (!bench.core().find_property("recording")->set(mauve::Value("lit.csv"))) return 1;
  if (const auto done = bench.configure(); !done)
    return std::puts(to_string(done.error()).c_str()), 2;
  const auto lit_after = [&bench](std::chrono::milliseconds later) {
    bench.advance(later);
    bench.core().update();
    const auto value = bench.written(bench.shell().out);
    return value && value->on;
  };
  using std::chrono::milliseconds;
  const bool dark = !lit_after(milliseconds(0)) && !lit_after(milliseconds(499));
  return dark && lit_after(milliseconds(1)) ? 0 : 3;
}
