// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/task_attributes.h>

#include <string_view>

namespace mauve {

std::string_view to_string(OnOverrun value) {
  switch (value) {
    case OnOverrun::catch_up:
      return "catch_up";
    case OnOverrun::skip:
      return "skip";
    case OnOverrun::stop:
      return "stop";
    case OnOverrun::fallback:
      return "fallback";
  }
  return "unknown";
}

std::string_view to_string(FaultPolicy::Action value) {
  switch (value) {
    case FaultPolicy::Action::stop:
      return "stop";
    case FaultPolicy::Action::restart:
      return "restart";
    case FaultPolicy::Action::fallback:
      return "fallback";
  }
  return "unknown";
}

}  // namespace mauve
