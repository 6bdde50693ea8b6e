// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/address.h"

#include <algorithm>

namespace mauve {
namespace {

constexpr std::string_view kNameHint =
    "names are lower-case letters, digits and '_', start with a letter and have at most 64 "
    "characters";

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string shortened(std::string_view text) {
  if (text.size() <= kLongestName) return std::string(text);
  return std::string(text.substr(0, kLongestName)) + "...";
}

bool is_revision(std::string_view text) {
  return !text.empty() && text.size() <= 9 && text.front() != '0' &&
         std::all_of(text.begin(), text.end(), is_digit);
}

}  // namespace

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= kLongestName && is_lower(text.front()) &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return is_lower(c) || is_digit(c) || c == '_'; });
}

bool is_type_name(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return is_name(text);
  return is_name(text.substr(0, slash)) && is_name(text.substr(slash + 1));
}

bool is_revised_name(std::string_view text) {
  const std::size_t slash = text.rfind('/');
  return slash != std::string_view::npos && is_type_name(text.substr(0, slash)) &&
         is_revision(text.substr(slash + 1));
}

Status check_name(std::string_view text, std::string_view at) {
  if (is_name(text)) return ok();
  return refuse({Errc::invalid_value, "not_a_name"}, std::string(at),
                "\"" + shortened(text) + "\" is not a name", std::string(kNameHint));
}

Result<Address> Address::parse(std::string_view text) {
  if (text.size() > kLongestAddress) {
    return refuse({Errc::limit, "address_too_long"}, shortened(text),
                  "an address has at most 255 characters");
  }
  Address address;
  address.text_ = text;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('.', begin), text.size());
    if (Status named = check_name(text.substr(begin, end - begin), text); !named) {
      return named.error();
    }
    address.parts_.push_back(begin);
    begin = end + 1;
  }
  return address;
}

std::string_view Address::part(std::size_t index) const {
  if (index >= parts_.size()) return {};
  const std::size_t begin = parts_[index];
  const std::size_t end = index + 1 < parts_.size() ? parts_[index + 1] - 1 : text_.size();
  return std::string_view(text_).substr(begin, end - begin);
}

std::string_view Address::rest() const {
  if (parts_.size() < 2) return {};
  return std::string_view(text_).substr(parts_[1]);
}

}  // namespace mauve
