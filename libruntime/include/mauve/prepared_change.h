// SPDX-License-Identifier: LGPL-3.0-or-later
/// PreparedChange: a change between prepare and commit.
#pragma once

#include <memory>

namespace mauve {

/// A change that was prepared and can be committed once. Owns what it made; dropping it cleans up
/// and frees the unused elements: do that on [factory].
class PreparedChange {
 public:
  class Content;
  explicit PreparedChange(std::unique_ptr<Content> content);
  PreparedChange(PreparedChange&&) noexcept;
  PreparedChange& operator=(PreparedChange&&) noexcept;
  ~PreparedChange();
  [[nodiscard]] Content& content() { return *content_; }
  /// Runtime only.
  [[nodiscard]] std::shared_ptr<Content> share() const { return content_; }

 private:
  std::shared_ptr<Content> content_;
};

}  // namespace mauve
