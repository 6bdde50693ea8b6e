// SPDX-License-Identifier: LGPL-3.0-or-later
/// Guarded: bytes that put an output into its safe state. mauved sends them when no job commands
/// the output any more: its component is stopped, fails or is removed, or its core leaves the
/// device. The guardian process sends them when mauved ends without notice, or falls silent. For
/// devices that go on with the last command they were given. A device that stops by itself when
/// commands cease is better: switch that on where there is one. Neither is an emergency stop.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/detail/configurable.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

/// An order to a device: the bytes, and the way in which they are sent.
struct SafeOrder {
  /// 1 to 256; the same at any time, so no protocol with a counter or a time in its frames.
  std::string_view bytes;
  /// How often the bytes are sent, 1 to 10. Choose 2 or more for a protocol in frames: the device
  /// may take the first frame for the rest of an interrupted one.
  int times = 1;
  /// From one sending to the next; all of them within 100 ms.
  Duration apart{0};
  /// Of a terminal: bytes that wait to be sent are dropped first, so that no older command follows.
  bool drop_unsent = true;
};

/// True in a job whose thread mauved has abandoned, because the job did not return within its
/// bound. The orders of its outputs have gone out, and no command of it may follow. A driver that
/// writes to a descriptor of its own asks after each call that may have waited. `mauve::serial`
/// does so. [any]
[[nodiscard]] bool is_abandoned();

/// An output that is made safe when its component cannot command it. Declared as a member of a core
/// or shell. No code of the plugin runs for that: mauved and the guardian have copies of the
/// descriptor and of the bytes. In a simulation or another program nothing happens. [factory], or
/// an ordinary thread of the plugin; never [rt].
/// @snippet api_examples.cpp Guarded
class Guarded {
 public:
  /// Holds nothing yet.
  Guarded(const Configurable& owner, std::string_view name);
  ~Guarded();
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  /// After the device was opened, or opened again: the order is sent to this descriptor from now
  /// on, in place of the one before. It is sent at once while the component stands or recovers. The
  /// descriptor stays the caller's, must have been opened with O_NONBLOCK, and may be closed after
  /// drop(). Refused when the order cannot be one, and under `mauved --guardian require` when there
  /// is no guardian.
  Status hold(int descriptor, const SafeOrder& order);
  /// Before the device is closed. After a stop it waits until the order has gone out, at most some
  /// 200 ms. When it returns, nothing is sent to the device any more, unless the guardian did not
  /// answer within a second.
  void drop();
  /// How often the order fell due so far. No command from before may reach the device after it, so
  /// a driver whose commands wait for a thread of its own drops those; `mauve::serial` does so.
  /// Null while it holds nothing; otherwise it lasts as long as the process, and any thread may
  /// read it. [any but rt]
  [[nodiscard]] const std::atomic<std::uint32_t>* times_due() const;
  /// Such a command was under way already, and may have come last: the order is sent again, unless
  /// a job commands the device. [any but rt]
  void repeat();

  /// Runtime only: does this core or shell have one, whether it holds an order or not? [any but rt]
  [[nodiscard]] static bool declared_by(const Configurable& owner);

 private:
  const Configurable& owner_;
  const std::string_view name_;
};

}  // namespace mauve
