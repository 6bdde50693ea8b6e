// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/parts.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

namespace bench {
namespace {

[[noreturn]] void usage(const char* program, const std::vector<std::string>& all) {
  std::cerr << "usage: " << program << " [--smoke] [--out FOLDER] [";
  for (const std::string& name : all) std::cerr << (&name == all.data() ? "" : "|") << name;
  std::cerr << "]...\n";
  std::exit(2);
}

}  // namespace

Parts parse_parts(int argc, char** argv, const std::vector<std::string>& all) {
  Parts parts;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--smoke") {
      parts.options.smoke = true;
      parts.options.rounds = 1;
    } else if (word == "--out" && i + 1 < argc) {
      parts.folder = argv[++i];
    } else if (std::find(all.begin(), all.end(), word) != all.end()) {
      parts.names.push_back(word);
    } else {
      usage(argv[0], all);
    }
  }
  if (parts.names.empty()) parts.names = all;
  return parts;
}

}  // namespace bench
