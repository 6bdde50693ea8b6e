// SPDX-License-Identifier: LGPL-3.0-or-later
/// What the algorithms of the paper's robot reach and cost.
#include "bench/robot.h"

int main(int argc, char** argv) {
  const bench::Options options = bench::parse(argc, argv);
  bench::report_localization(options);
}
