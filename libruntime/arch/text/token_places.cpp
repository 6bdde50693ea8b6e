// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/token_places.h"

namespace mauve::arch {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; }
bool is_between_tokens(char c) {
  return std::string_view(" \t\r\n,:").find(c) != std::string_view::npos;
}
bool is_mark(char c) { return std::string_view("{}[]").find(c) != std::string_view::npos; }

}  // namespace

TokenPlaces::TokenPlaces(std::string_view text) : text_(text) {
  if (text_.starts_with(kByteOrderMark)) offset_ = kByteOrderMark.size();
}

Position TokenPlaces::next() {
  skip_between_tokens();
  const Position place = place_;
  if (at_end()) return place;
  if (text_[offset_] == '"') {
    skip_string();
  } else if (is_mark(text_[offset_])) {
    advance();
  } else {
    skip_word();
  }
  return place;
}

Position TokenPlaces::place_of(std::string_view text, std::size_t offset) {
  TokenPlaces walk(text);
  while (!walk.at_end() && walk.offset_ < offset) walk.advance();
  return walk.place_;
}

void TokenPlaces::advance() {
  const char passed = text_[offset_++];
  if (passed == '\n') {
    place_ = {place_.line + 1, 1};
  } else if (at_end() || !continues_character(text_[offset_])) {
    ++place_.column;
  }
}

void TokenPlaces::skip_between_tokens() {
  while (!at_end()) {
    if (text_[offset_] == '/') {
      skip_comment();
    } else if (is_between_tokens(text_[offset_])) {
      advance();
    } else {
      return;
    }
  }
}

void TokenPlaces::skip_comment() {
  const bool block = text_.substr(offset_).starts_with("/*");
  const std::size_t found =
      block ? text_.find("*/", offset_ + 2) : text_.find_first_of("\r\n", offset_);
  const std::size_t end = found == std::string_view::npos ? text_.size() : found + (block ? 2 : 0);
  while (offset_ < end) advance();
}

void TokenPlaces::skip_string() {
  advance();
  while (!at_end() && text_[offset_] != '"') {
    if (text_[offset_] == '\\') advance();
    if (!at_end()) advance();
  }
  if (!at_end()) advance();
}

void TokenPlaces::skip_word() {
  while (!at_end() && !is_between_tokens(text_[offset_]) && !is_mark(text_[offset_]) &&
         text_[offset_] != '/' && text_[offset_] != '"') {
    advance();
  }
}

}  // namespace mauve::arch
