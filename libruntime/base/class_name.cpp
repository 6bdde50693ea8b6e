// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/class_name.h>

#include <cstdlib>
#include <memory>

#include <cxxabi.h>

namespace mauve {

std::string class_name(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), std::free);
  return status == 0 ? text.get() : type.name();
}

}  // namespace mauve
