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
      return "did not return";
    case Cause::asked:
      return "asked";
  }
  return "unknown";
}

std::string_view word_of(Cause cause) {
  constexpr std::array<std::string_view, 7> kWords{
      "threw", "implausible", "over_budget", "overruns", "crashed", "hung", "asked"};
  return kWords.at(static_cast<std::size_t>(cause));
}

}  // namespace mauve::exec
