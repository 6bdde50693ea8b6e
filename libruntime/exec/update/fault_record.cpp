// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/update/fault_record.h"

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
      return "hung";
    case Cause::asked:
      return "asked";
  }
  return "unknown";
}

std::string_view word_of(Cause cause) { return kCauseWords.at(static_cast<std::size_t>(cause)); }

std::optional<Cause> cause_of(std::string_view text) {
  for (std::size_t i = 0; i < kCauseWords.size(); ++i) {
    if (to_string(static_cast<Cause>(i)) == text) return static_cast<Cause>(i);
  }
  return std::nullopt;
}

}  // namespace mauve::exec
