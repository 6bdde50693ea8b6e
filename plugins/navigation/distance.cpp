// SPDX-License-Identifier: LGPL-3.0-or-later
#include "distance.h"

#include <algorithm>

namespace navigation {
namespace {

constexpr std::uint16_t kReach = 255;  // cells, the root of kFar

/// Quotient rounded down; the divisor is positive.
int floor_divided(int number, int by) {
  return number >= 0 ? number / by : -((by - 1 - number) / by);
}

}  // namespace

Distances::Distances(std::size_t cells)
    : squared_(cells, kFar),
      above_(Frame::kLongestSide),
      apex_(Frame::kLongestSide),
      begins_(Frame::kLongestSide) {}

void Distances::measure(const Frame& frame, bool border) {
  const auto width = static_cast<std::size_t>(frame.width());
  const auto height = static_cast<std::size_t>(frame.height());
  down_the_columns(width, height, border);
  for (std::size_t y = 0; y < height; ++y) {
    along_the_row(squared_.data() + y * width, frame.width(), border);
  }
}

/// Leaves in each cell how many cells the next solid one is above or below, at most kReach. Row by
/// row, since memory is.
void Distances::down_the_columns(std::size_t width, std::size_t height, bool border) {
  const std::uint16_t outside = border ? 0 : kReach;
  const auto nearer = [](std::uint16_t& cell, std::uint16_t neighbour) {
    const auto by_way_of = static_cast<std::uint16_t>(neighbour + 1);
    cell = std::min({cell, by_way_of, kReach});
  };
  std::uint16_t* const cells = squared_.data();
  for (std::size_t x = 0; x < width; ++x) nearer(cells[x], outside);
  for (std::size_t i = width; i < width * height; ++i) nearer(cells[i], cells[i - width]);
  std::uint16_t* const last = cells + width * (height - 1);
  for (std::size_t x = 0; x < width; ++x) nearer(last[x], outside);
  for (std::size_t i = width * (height - 1); i-- > 0;) nearer(cells[i], cells[i + width]);
}

void Distances::along_the_row(std::uint16_t* row, int width, bool border) {
  int count = 0;
  for (int x = 0; x < width; ++x) {
    above_[static_cast<std::size_t>(x)] = row[x] * row[x];
    if (row[x] >= kReach) continue;
    const int height = above_[static_cast<std::size_t>(x)];
    int begins = 0;
    for (; count > 0; --count) {
      const auto top = static_cast<std::size_t>(count - 1);
      const int other = apex_[top];
      const int difference =
          height + x * x - above_[static_cast<std::size_t>(other)] - other * other;
      begins = floor_divided(difference, 2 * (x - other)) + 1;
      if (begins > begins_[top]) break;
      begins = 0;
    }
    if (begins >= width) continue;
    apex_[static_cast<std::size_t>(count)] = x;
    begins_[static_cast<std::size_t>(count++)] = begins;
  }
  int next = 0;
  for (int x = 0; x < width; ++x) {
    while (next < count && begins_[static_cast<std::size_t>(next)] <= x) ++next;
    int least = kFar;
    if (next > 0) {
      const int apex = apex_[static_cast<std::size_t>(next - 1)];
      least = (x - apex) * (x - apex) + above_[static_cast<std::size_t>(apex)];
    }
    if (border) least = std::min({least, (x + 1) * (x + 1), (width - x) * (width - x)});
    row[x] = static_cast<std::uint16_t>(std::min<int>(least, kFar));
  }
}

}  // namespace navigation
