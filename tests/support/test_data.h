// SPDX-License-Identifier: LGPL-3.0-or-later
/// Where the real recordings are: $MAUVE_TEST_DATA, or ../shared/data beside the project.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

namespace support {

/// The folder or file of that name among the recordings; nothing when there are none here.
inline std::optional<std::filesystem::path> test_data(const std::string& name) {
  const char* set = std::getenv("MAUVE_TEST_DATA");
  const std::filesystem::path root = MAUVE_SOURCE_DIR;
  const std::filesystem::path base = set != nullptr ? set : root / ".." / "shared" / "data";
  const std::filesystem::path path = base / name;
  if (!std::filesystem::exists(path)) return {};
  return path;
}

/// The reason and the remedy, for GTEST_SKIP().
inline constexpr const char* kNoTestData =
    "SKIPPED: the recordings are not here; set MAUVE_TEST_DATA to their folder";

/// All bytes of a file.
inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace support
