// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/transaction.h"

#include <cstring>

namespace mauve::exec {

std::string_view to_string(Cause cause) {
  switch (cause) {
    case Cause::threw:
      return "threw";
    case Cause::implausible:
      return "wrote a value that is not plausible";
    case Cause::over_budget:
      return "took longer than its budget";
    case Cause::overruns:
      return "overran too often";
    case Cause::crashed:
      return "crashed";
    case Cause::hung:
      return "did not return";
    case Cause::asked:
      return "asked";
  }
  return "unknown";
}

bool WayBack::set_off(Instant instant, Cause cause, const void* member, const char* text) {
  if (!transaction_.set_off(instant)) return false;
  cause_ = cause;
  member_ = member;
  std::strncpy(text_.data(), text, text_.size() - 1);
  told_.store(true, std::memory_order_release);
  return true;
}

}  // namespace mauve::exec
