// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/class_name.h>

#include <cstdlib>
#include <memory>
#include <string_view>

#include <cxxabi.h>

namespace mauve {
namespace {

/// Parts of a name that compilers add and no author wrote.
constexpr std::string_view kAdded[] = {"(anonymous namespace)::", "__cxx11::"};

std::string as_written(std::string name) {
  for (const std::string_view added : kAdded) {
    for (auto at = name.find(added); at != std::string::npos; at = name.find(added, at)) {
      name.erase(at, added.size());
    }
  }
  return name;
}

}  // namespace

std::string class_name(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), std::free);
  return status == 0 ? as_written(text.get()) : type.name();
}

}  // namespace mauve
