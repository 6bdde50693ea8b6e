// SPDX-License-Identifier: LGPL-3.0-or-later
/// The results and the cost of the algorithms of the paper's robot: `robot [PART...] [OPTIONS]`.
#include "bench/robot.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace {

struct Part {
  std::string_view name;
  void (*report)(const bench::Options& options);
};
constexpr std::array kParts{Part{"localization", bench::report_localization},
                            Part{"navigation", bench::report_navigation},
                            Part{"control", bench::report_control}};

}  // namespace

int main(int argc, char** argv) {
  std::vector<const Part*> wanted;
  int read = 1;
  for (; read < argc; ++read) {
    const auto part = std::find_if(kParts.begin(), kParts.end(),
                                   [&](const Part& known) { return known.name == argv[read]; });
    if (part == kParts.end()) break;
    wanted.push_back(&*part);
  }
  static char program[] = "robot [localization] [navigation] [control]";
  argv[read - 1] = program;  // for its usage text
  const bench::Options options = bench::parse(argc - read + 1, argv + read - 1);
  for (const Part& part : kParts) {
    const bool all = wanted.empty();
    if (all || std::find(wanted.begin(), wanted.end(), &part) != wanted.end()) {
      part.report(options);
    }
  }
}
