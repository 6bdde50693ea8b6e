// SPDX-License-Identifier: LGPL-3.0-or-later
/// A private copy of a plugin in memory: no process can change it while its code runs.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "mauve/result.h"
#include "rt/process/descriptor.h"

namespace mauve::plugin {

/// A sealed memory file. [factory]
class Image {
 public:
  Image() = default;
  /// Copies and seals the bytes. `label` is for people who read /proc/PID/maps.
  static Result<Image> seal(std::span<const std::byte> bytes, const std::string& label);

  /// A path for dlopen that no library mapped in this process has had before: glibc would hand out
  /// the old code again.
  [[nodiscard]] std::string path() const;
  /// How many images were made before, plus one.
  [[nodiscard]] std::size_t serial() const { return serial_; }
  /// Its name in /proc/self/maps, never used twice in a process.
  [[nodiscard]] const std::string& mapping() const { return mapping_; }
  /// Keeps the path reserved for ever, because the code could not be unmapped.
  void abandon() { file_.release(); }

 private:
  rt::Descriptor file_;
  std::string mapping_;  // "/memfd:mauve:guidance-1.0.0-1f2e3d4c.7"
  std::size_t serial_ = 0;
};

/// Makes a memory file constant for ever. The kernel refuses that as busy when another part of the
/// kernel holds a reference to a page of the file for 150 ms. Such references come from pages that
/// it moves, and from pipes. So the call is repeated for about 1.5 s. `before_retry` is called in
/// between. [factory]
[[nodiscard]] Status seal_file(
    int file, const std::function<void()>& before_retry = [] {});

/// Is any part of the image with this name mapped? Looks at /proc/self/maps.
[[nodiscard]] bool is_mapped(const std::string& mapping);

}  // namespace mauve::plugin
