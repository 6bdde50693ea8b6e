// SPDX-License-Identifier: LGPL-3.0-or-later
/// Elements that a change took out of force.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <mauve/detail/configurable.h>

namespace mauve {

/// Elements that are no longer in force. Cleaned up and freed by release() or the destructor, which
/// run user code: [factory].
class Retired {
 public:
  Retired() = default;           ///< empty
  Retired(Retired&&) = default;  ///< leaves an empty one
  /// Releases the elements that it held.
  Retired& operator=(Retired&& other) noexcept {
    static_cast<void>(release());
    elements_.swap(other.elements_);
    owners_.swap(other.owners_);
    return *this;
  }
  ~Retired() { static_cast<void>(release()); }

  /// Cleans up in the reverse order of dependency; the first error of a hook is returned. An
  /// element whose clean-up failed stays in memory, with all that come after it.
  Status release();
  /// Runtime only: the added elements are in force now.
  void forget() {
    elements_.clear();
    owners_.clear();
  }
  /// Runtime only: in the order of dependency.
  void add(std::shared_ptr<Configurable> element) { elements_.push_back(std::move(element)); }
  /// Runtime only: freed after the elements, the last one first; keep_longest(): after all others.
  void keep(std::shared_ptr<void> owner);
  void keep_longest(std::shared_ptr<void> owner);  ///< see keep()
  void merge(Retired&& other);                     ///< adds all of the other
  /// Nothing to release.
  [[nodiscard]] bool empty() const { return elements_.empty() && owners_.empty(); }

 private:
  std::vector<std::shared_ptr<void>> owners_;
  std::vector<std::shared_ptr<Configurable>> elements_;
};

}  // namespace mauve
