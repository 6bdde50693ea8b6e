// SPDX-License-Identifier: LGPL-3.0-or-later
/// A private copy of a plugin file: nobody can change it under the feet of the code that runs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/result.h"

namespace mauve::plugin {

inline constexpr std::size_t kLargestPlugin = std::size_t{256} << 20;

/// Sealed memory file with the bytes of a plugin. Closes it in the end. [factory]
class Image {
 public:
  Image() = default;
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;
  ~Image();

  /// Finds NAME.so in the first directory that has it, checks that nobody untrusted can have
  /// written it (trust.h), copies and seals it. `name` is a name, never a path.
  static Result<Image> read(const std::vector<std::string>& directories, std::string_view name);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// "/usr/lib/mauve/plugins/guidance.so"
  [[nodiscard]] const std::string& file() const { return file_; }
  /// The sealed bytes.
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  /// A path for dlopen that no other library of this process has had while it was mapped.
  [[nodiscard]] std::string path() const;
  /// What /proc/self/maps calls it; never used twice in a process.
  [[nodiscard]] const std::string& mapping() const { return mapping_; }
  [[nodiscard]] std::uint64_t serial() const { return serial_; }

  /// Keeps the path reserved for ever: the code could not be unmapped.
  void abandon() { descriptor_ = -1; }

 private:
  Status copy(int file, std::size_t size);

  std::string name_;
  std::string file_;
  std::string mapping_;
  std::uint64_t serial_ = 0;
  int descriptor_ = -1;
  std::span<const std::byte> bytes_;
};

}  // namespace mauve::plugin
