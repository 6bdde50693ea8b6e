// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finds where the tokens of a JSON text stand. The parser that judges the text gives no places,
/// so this follows it, one token for each of its events.
#pragma once

#include <cstddef>
#include <string_view>

#include "arch/text/problem.h"

namespace mauve::arch {

/// Walks over the tokens that make parser events: braces, brackets, strings, numbers, literals.
/// Only meaningful on the part of a text that a JSON parser has accepted; safe on any.
class TokenPlaces {
 public:
  explicit TokenPlaces(std::string_view text);

  /// The place of the next token, which is thereby passed; at the end, the place of the end.
  Position next();

  /// The place of the character at `offset`, counted from the begin of the text.
  [[nodiscard]] static Position place_of(std::string_view text, std::size_t offset);

 private:
  [[nodiscard]] bool at_end() const { return offset_ >= text_.size(); }
  void advance();
  void skip_between_tokens();
  void skip_comment();
  void skip_string();
  void skip_word();

  std::string_view text_;
  std::size_t offset_ = 0;
  Position place_{1, 1};
};

}  // namespace mauve::arch
