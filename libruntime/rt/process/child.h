// SPDX-License-Identifier: LGPL-3.0-or-later
/// A child process that does one piece of work: text goes in, text comes out, and nothing that it
/// does touches this process. Not on a real-time thread.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "mauve/result.h"
#include "mauve/time.h"
#include "rt/process/descriptor.h"

namespace mauve::rt {

/// The limits of the calling process from now on.
struct ChildLimits {
  std::uint64_t memory = 0;  ///< bytes of its own writable memory
  std::uint64_t file = 0;    ///< bytes of the longest file that it writes
  Duration processor{0};     ///< time on a processor, rounded up to whole seconds
};

/// [the child, its first statement] Ends the process together with its parent. Takes its
/// capabilities and its right to real-time scheduling away, makes it less urgent than others (nice
/// 5) and the first process that a kernel without memory ends. A limit that the kernel refuses
/// stays as it was. A build with a sanitizer has no limit on memory, because the sanitizer reserves
/// terabytes.
void confine(const ChildLimits& limits);

/// A quarter of the memory of the machine.
[[nodiscard]] std::uint64_t quarter_of_memory();

/// How a child ended.
struct ChildEnd {
  enum class How : std::uint8_t {
    exited,     ///< by itself, with `code`
    signalled,  ///< by the signal `code`
    late,       ///< it was killed, because it did not end in time
    cancelled   ///< it was killed by cancel()
  };
  How how = How::exited;
  int code = 0;
  std::string output;  ///< all that it wrote to its standard output
  std::string errors;  ///< and to its standard error
};

/// Runs one child after another.
class ChildRunner {
 public:
  /// Runs `command` (its first word is the path of the program) and waits until it ends, at most
  /// `within`. The child gets `input` on its standard input, no other descriptor, default signals
  /// and ordinary scheduling. After `within` it gets SIGTERM, and SIGKILL 200 ms later, with all
  /// processes of its group. Refused when it cannot be started. [one thread]
  [[nodiscard]] Result<ChildEnd> run(const std::vector<std::string>& command,
                                     const std::string& input, Duration within);
  /// Kills the child that runs now and each later one. [any]
  void cancel();

 private:
  [[nodiscard]] Result<pid_t> spawn(const std::vector<std::string>& command, int input, int output,
                                    int errors);
  [[nodiscard]] ChildEnd wait(pid_t child, Duration within);

  Mutex mutex_;  // of the members below
  bool cancelled_ MAUVE_GUARDED_BY(mutex_) = false;
  pid_t child_ MAUVE_GUARDED_BY(mutex_) = 0;  // not reaped yet; 0: none
};

}  // namespace mauve::rt
