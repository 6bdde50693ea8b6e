// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/data_status.h>

#include <string_view>

namespace mauve {

std::string_view to_string(DataStatus status) {
  switch (status) {
    case DataStatus::no_data:
      return "no_data";
    case DataStatus::old_data:
      return "old_data";
    case DataStatus::new_data:
      return "new_data";
    case DataStatus::stale:
      return "stale";
    case DataStatus::timed_out:
      return "timed_out";
    case DataStatus::poisoned:
      return "poisoned";
  }
  return "unknown";
}

}  // namespace mauve
