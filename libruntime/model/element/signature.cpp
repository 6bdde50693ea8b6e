// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/signature.h>

#include <string>
#include <string_view>

namespace mauve {

std::string_view to_string(PortKind kind) {
  switch (kind) {
    case PortKind::read:
      return "read";
    case PortKind::write:
      return "write";
    case PortKind::call:
      return "call";
    case PortKind::event:
      return "event";
  }
  return "unknown";
}

std::string to_string(const Signature& signature) {
  return std::string(to_string(signature.kind)) + " " + signature.types;
}

}  // namespace mauve
