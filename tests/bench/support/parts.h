// SPDX-License-Identifier: LGPL-3.0-or-later
/// The command line of a benchmark with parts: `NAME [--smoke] [--out FOLDER] [PART]...`
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/support/report.h"

namespace bench {

struct Parts {
  Options options;
  std::filesystem::path folder;    ///< for files; empty: none
  std::vector<std::string> names;  ///< never empty
};
/// Without a name: all. Ends the program with a usage text when it does not understand.
[[nodiscard]] Parts parse_parts(int argc, char** argv, const std::vector<std::string>& all);

}  // namespace bench
