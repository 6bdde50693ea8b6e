// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauvectl as a process of a test. MAUVE_BIN_DIR is defined by the CMakeLists.txt of the test.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "support/process.h"

namespace mauve::test {

/// How a program ended, and its output.
struct Said {
  int exit = -1;
  std::string out;
  std::string err = {};  ///< empty where it went to nowhere
};

/// The command line of `mauvectl WORDS...` for the mauved on this socket.
[[nodiscard]] inline std::vector<std::string> mauvectl_words(
    const std::string& socket, const std::vector<std::string>& words) {
  std::vector<std::string> all{MAUVE_BIN_DIR "/mauvectl", "--socket", socket};
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

/// Runs it; its standard error goes to the end of `errors`, or to nowhere.
inline Said mauvectl(const std::string& socket, const std::vector<std::string>& words,
                     const std::string& errors = "/dev/null") {
  std::error_code no_file;
  const auto size = std::filesystem::file_size(errors, no_file);
  Process client(mauvectl_words(socket, words), errors);
  std::string out = client.all_output();
  const int exit = client.wait();
  std::ifstream file(errors);
  if (!no_file) file.seekg(static_cast<std::streamoff>(size));
  return {exit, std::move(out), {std::istreambuf_iterator<char>(file), {}}};
}

}  // namespace mauve::test
