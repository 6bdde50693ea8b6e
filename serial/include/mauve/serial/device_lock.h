// SPDX-License-Identifier: LGPL-3.0-or-later
/// DeviceLock: a serial device belongs to one process, and there to one component.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mauve::serial {

/// Two locks that the kernel keeps while a descriptor of their own is open: that of the line goes
/// to the guardian, which outlives the process.
///
/// The lock of flock(2) keeps other processes away. It holds against root too, and other programs
/// for serial lines ask for it as well. All lines of this process share it, so a core takes the
/// line over from the one that it replaces.
///
/// A record lock (F_OFD_SETLK, fcntl(2)) at a place that stands for the component is seen by the
/// lines of other components. They may be in other plugins, and know the device by another name.
class DeviceLock {
 public:
  /// The outcome of take().
  /// `unknown`: the lock could not be asked for, and errno says why; the device is not to be used.
  enum class Found : std::uint8_t { free, other_process, other_component, unknown };
  /// The first opening of a line shares the device with another component. A change that puts one
  /// driver in place of another needs that, and mauved refuses two drivers of one device before. A
  /// component of which another line waits for the device already has no such first opening.
  enum class Opening : bool { first, again };

  DeviceLock() = default;
  ~DeviceLock() { release(); }
  DeviceLock(const DeviceLock&) = delete;
  DeviceLock& operator=(const DeviceLock&) = delete;

  /// An address in the component, such as "base.core". Without one it has no component, and shares
  /// the device with all of this process. Before take(). [factory]
  void belongs_to(std::string_view address);
  /// Of the terminal that `line` is open on, by its path. Takes no memory.
  Found take(int line, const char* path, Opening opening);
  /// Another line of this process had the device before. After take().
  [[nodiscard]] bool is_shared() const { return shared_; }
  /// A line of another component waits for the device that this one has. After take().
  [[nodiscard]] bool is_awaited() const;
  /// Others may take the device from now on.
  void release();

 private:
  void wait_for_it();
  Found unknown();

  int own_ = -1;             // with the record lock
  int lock_ = -1;            // with the lock of the process
  bool shared_ = false;      // which another line took
  std::int64_t place_ = -1;  // of the component; -1: it has none
};

/// "process 4711 (mauved)", or "another process" where the system does not say.
[[nodiscard]] std::string holder_of(const std::string& path);

}  // namespace mauve::serial
