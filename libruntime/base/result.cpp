// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mauve/result.h"

namespace mauve {

std::string_view to_string(Errc code) {
  switch (code) {
    case Errc::invalid_value:
      return "invalid_value";
    case Errc::unknown_name:
      return "unknown_name";
    case Errc::duplicate:
      return "duplicate";
    case Errc::type_mismatch:
      return "type_mismatch";
    case Errc::wrong_state:
      return "wrong_state";
    case Errc::hook_failed:
      return "hook_failed";
    case Errc::hook_threw:
      return "hook_threw";
    case Errc::cycle:
      return "cycle";
    case Errc::abi_mismatch:
      return "abi_mismatch";
    case Errc::plugin_refused:
      return "plugin_refused";
    case Errc::not_permitted:
      return "not_permitted";
    case Errc::conflict:
      return "conflict";
    case Errc::partly:
      return "partly";
    case Errc::timed_out:
      return "timed_out";
    case Errc::limit:
      return "limit";
    case Errc::unsupported:
      return "unsupported";
    case Errc::system:
      return "system";
  }
  return "unknown";
}

std::string to_string(const Error& error) {
  std::string text = error.at;
  if (!text.empty()) text += ": ";
  text += error.message;
  if (!error.hint.empty()) text += " (" + error.hint + ")";
  return text;
}

}  // namespace mauve
