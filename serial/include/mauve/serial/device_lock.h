// SPDX-License-Identifier: LGPL-3.0-or-later
/// DeviceLock: a serial device belongs to one process.
#pragma once

#include <string>

namespace mauve::serial {

/// A lock of flock(2), which holds against root too, and which other programs for serial lines ask
/// for as well. It lies on a descriptor of its own: that of the line goes to the guardian, which
/// outlives the process. All lines of this process share it, so a core takes the line over from the
/// one that it replaces.
class DeviceLock {
 public:
  DeviceLock() = default;
  ~DeviceLock() { release(); }
  DeviceLock(const DeviceLock&) = delete;
  DeviceLock& operator=(const DeviceLock&) = delete;

  /// Of the terminal that `line` is open on, by its path. False: another process holds it. Takes no
  /// memory.
  bool take(int line, const char* path);
  /// Another process may take the device from now on.
  void release();

 private:
  int lock_ = -1;
};

/// "process 4711 (mauved)", or "another process" where the system does not say.
[[nodiscard]] std::string holder_of(const std::string& path);

}  // namespace mauve::serial
