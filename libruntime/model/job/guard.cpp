// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/job/guard.h"

#include <array>
#include <csignal>

#include "rt/thread/stack.h"

namespace mauve::detail {

Error crashed(const std::string& at, const char* hook, const rt::Fault& fault) {
  if (fault.interrupted) {
    return refuse({Errc::timed_out, "hook_did_not_return"}, at,
                  std::string(hook) + " did not return, so it was ended",
                  "correct it; the log says whether the change is in force");
  }
  std::array<char, 160> text{};
  rt::describe(fault, text.data(), text.size());
  const std::string how = fault.call != nullptr ? " called " : " crashed: ";
  if (fault.because != nullptr) {
    return refuse({Errc::hook_threw, "hook_changes_process"}, at, hook + how + text.data(),
                  "take the call out of the code");
  }
  const bool full = fault.signal == SIGSEGV && rt::below_stack(fault.address);
  return refuse(
      {Errc::hook_threw, "hook_crashed"}, at,
      hook + how + text.data() + (full ? ", as its stack is full" : ""),
      "correct it; memory that it may have damaged is not repaired, so restart mauved when "
      "the robot stands");
}

}  // namespace mauve::detail
