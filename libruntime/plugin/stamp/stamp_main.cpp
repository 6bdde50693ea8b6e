// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauve-stamp FILE...: the last step of building a plugin, which mauve_add_plugin() does.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "plugin/elf/checksum.h"

namespace {

/// Empty: done.
std::string stamp_file(const std::filesystem::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  if (!file) return std::string("cannot be opened for writing: ") + std::strerror(errno);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto done = mauve::plugin::stamp(std::as_writable_bytes(std::span(text)));
  if (!done) return done.error().message + " (" + done.error().hint + ")";
  file.clear();
  file.seekp(0);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  return file ? "" : std::string("cannot be written: ") + std::strerror(errno);
}

}  // namespace

int main(int argc, char** argv) {
  const std::span words(argv, static_cast<std::size_t>(argc));
  if (argc < 2 || std::string(words[1]).starts_with("-")) {
    const int written = std::puts(
        "Usage: mauve-stamp PLUGIN.so...\n"
        "Writes into each plugin the checksum by which mauved notices damage of the file.\n"
        "mauve_add_plugin() runs it after linking; run it again after any tool that changes the "
        "file.");
    if (written < 0 || std::fflush(stdout) != 0) {
      std::fprintf(stderr, "mauve-stamp: the help cannot be written: %s\n", std::strerror(errno));
      return 1;
    }
    return argc < 2 ? 2 : 0;
  }
  int wrong = 0;
  for (const char* name : words.subspan(1)) {
    if (const auto refused = stamp_file(name); !refused.empty()) {
      std::fprintf(stderr, "mauve-stamp: %s: %s\n", name, refused.c_str());
      wrong = 1;
    }
  }
  return wrong;
}
