// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/report.h>

#include <string>
#include <string_view>

namespace mauve {

std::string_view to_string(ComponentState state) {
  switch (state) {
    case ComponentState::not_configured:
      return "not_configured";
    case ComponentState::stopped:
      return "stopped";
    case ComponentState::running:
      return "running";
    case ComponentState::faulted:
      return "faulted";
    case ComponentState::recovering:
      return "recovering";
  }
  return "unknown";
}

std::string to_string(const Incident& incident) {
  const std::string text = incident.text.empty() ? "" : ": " + incident.text;
  const bool own = incident.resource.empty();
  return incident.cause + text + (own ? "" : ", in a call of " + incident.resource);
}

std::string_view to_string(Recovery::Way way) {
  switch (way) {
    case Recovery::Way::none:
      return "none";
    case Recovery::Way::restart:
      return "restart";
    case Recovery::Way::fallback:
      return "fallback";
    case Recovery::Way::rollback:
      return "rollback";
  }
  return "unknown";
}

std::string_view to_string(Outcome::Kind kind) {
  switch (kind) {
    case Outcome::Kind::passed:
      return "passed";
    case Outcome::Kind::overtaken:
      return "overtaken";
    case Outcome::Kind::rolled_back:
      return "rolled_back";
    case Outcome::Kind::fell_back:
      return "fell_back";
    case Outcome::Kind::restarted:
      return "restarted";
    case Outcome::Kind::stays_failed:
      return "stays_failed";
  }
  return "unknown";
}

}  // namespace mauve
