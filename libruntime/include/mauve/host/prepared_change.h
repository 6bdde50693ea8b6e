// SPDX-License-Identifier: LGPL-3.0-or-later
/// PreparedChange: a change between prepare and commit.
#pragma once

#include <memory>
#include <utility>

#include <mauve/host/retired.h>

namespace mauve {

/// A change that was prepared and can be committed once. Owns the elements that it made. Its
/// destructor cleans up and frees those that are unused: destroy it on [factory].
class PreparedChange {
 public:
  class Content;
  /// `elements`: all of the architecture that it was prepared against. Its connections lead to some
  /// of them, so they stay alive with it, although a rollback may take them out meanwhile.
  explicit PreparedChange(std::unique_ptr<Content> content, Retired elements = {});
  PreparedChange(PreparedChange&&) noexcept;  ///< the other one is empty then
  /// Drops the change that it held.
  PreparedChange& operator=(PreparedChange&& other) noexcept {
    content_ = std::move(other.content_);  // connections go before the resources they lead to
    elements_ = std::move(other.elements_);
    return *this;
  }
  ~PreparedChange();
  [[nodiscard]] Content& content() { return *content_; }  ///< runtime only
  /// Runtime only.
  [[nodiscard]] std::shared_ptr<Content> share() const { return content_; }

 private:
  Retired elements_;
  std::shared_ptr<Content> content_;
};

}  // namespace mauve
