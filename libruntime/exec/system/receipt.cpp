// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/receipt.h>

#include <string_view>

namespace mauve {

std::string_view to_string(ChangeState state) {
  switch (state) {
    case ChangeState::unchanged:
      return "unchanged";
    case ChangeState::applied:
      return "applied";
  }
  return "unknown";
}

}  // namespace mauve
