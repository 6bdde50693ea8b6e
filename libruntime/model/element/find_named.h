// SPDX-License-Identifier: LGPL-3.0-or-later
/// The one way to look a thing up by its name in a list of pointers.
#pragma once

#include <string_view>
#include <vector>

namespace mauve {

/// Null when nothing has this name.
template <typename T>
T* find_named(const std::vector<T*>& items, std::string_view name) {
  for (T* item : items) {
    if (item->name() == name) return item;
  }
  return nullptr;
}

}  // namespace mauve
