// SPDX-License-Identifier: LGPL-3.0-or-later
/// Source of the format: netpbm's pgm(5).
#include <algorithm>
#include <charconv>
#include <optional>

#include "grid_frame.h"
#include "map_file.h"

namespace navigation {
namespace {

using mauve::Errc;
using mauve::refuse;

constexpr int kLargestNumber = 65535;
constexpr std::string_view kBlank = " \t\r\n\v\f";

bool blank(char c) { return kBlank.find(c) != std::string_view::npos; }

/// Takes numbers off the front of the text; # begins a comment up to the end of the line.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) {}

  /// Nothing where there is none, or one that no image has.
  std::optional<int> next() {
    skip();
    int number = 0;
    const char* const end = text_.data() + text_.size();
    const auto [at, error] = std::from_chars(text_.data(), end, number);
    const bool ended = at == end || blank(*at) || *at == '#';
    if (error != std::errc() || number < 0 || number > kLargestNumber || !ended) return {};
    text_.remove_prefix(static_cast<std::size_t>(at - text_.data()));
    return number;
  }
  /// The text after the one blank behind the header.
  [[nodiscard]] std::string_view rest() const { return text_.empty() ? text_ : text_.substr(1); }

 private:
  void skip() {
    while (!text_.empty() && (blank(text_.front()) || text_.front() == '#')) {
      const bool comment = text_.front() == '#';
      const std::size_t end = comment ? text_.find('\n') : text_.find_first_not_of(kBlank);
      text_.remove_prefix(std::min(end, text_.size()));
    }
  }
  std::string_view text_;
};

std::string cells_of(std::size_t count) { return std::to_string(count) + " cells"; }

}  // namespace

mauve::Result<MapImage> parse_pgm(std::string_view bytes, const std::string& name) {
  const bool plain = bytes.starts_with("P2");
  if ((!plain && !bytes.starts_with("P5")) || bytes.size() < 3 || !blank(bytes[2])) {
    return refuse(Errc::invalid_value, {}, name + ": is no PGM image",
                  "P5 and P2 are read; 'convert map.png map.pgm' makes one");
  }
  Numbers numbers(bytes.substr(2));
  const auto width = numbers.next();
  const auto height = numbers.next();
  const auto top = numbers.next();
  if (!width || !height || !top || *width == 0 || *height == 0) {
    return refuse(Errc::invalid_value, {}, name + ": its header has no sensible size",
                  "after P5 or P2 stand width, height and the largest level");
  }
  const auto count = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  if (count > OccupancyGrid::kCapacity || std::max(*width, *height) > Frame::kLongestSide) {
    return refuse(Errc::limit, {}, name + ": has " + cells_of(count),
                  "a map has at most " + cells_of(OccupancyGrid::kCapacity) + " and sides of " +
                      cells_of(Frame::kLongestSide) + ": cut it, or make its cells larger");
  }
  if (*top == 0 || *top > 255) {
    return refuse(Errc::unsupported, {}, name + ": its largest level is " + std::to_string(*top),
                  "levels from 0 to 255 are read");
  }
  MapImage image{*width, *height, {}};
  image.levels.reserve(count);
  const std::string_view raw = numbers.rest();
  for (std::size_t i = 0; i < count; ++i) {
    std::optional<int> level;
    if (plain) {
      level = numbers.next();
    } else if (i < raw.size()) {
      level = static_cast<unsigned char>(raw[i]);
    }
    if (!level || *level > *top) {
      return refuse(
          Errc::invalid_value, {},
          name + ": has no level for cell " + std::to_string(i) + " of " + std::to_string(count),
          "the file is damaged, or shorter than its header says");
    }
    image.levels.push_back(static_cast<std::uint8_t>(*level * 255 / *top));
  }
  // A picture out of place shows in no other way: of a header that ends its lines with CR LF.
  if (!plain && raw.size() > count) {
    return refuse(
        Errc::invalid_value, {},
        name + ": has " + std::to_string(raw.size()) + " bytes of levels for " + cells_of(count),
        "one blank ends the header (no CR LF), and nothing follows the last level: write "
        "the image anew");
  }
  if (plain && numbers.next()) {
    return refuse(Errc::invalid_value, {}, name + ": has more levels than " + cells_of(count),
                  "nothing follows the last level: the file is damaged, or its header is wrong");
  }
  return image;
}

}  // namespace navigation
