// SPDX-License-Identifier: LGPL-3.0-or-later
/// How far each cell of a map is from the next solid one: exact Euclidean distance between centres.
#pragma once

#include <cstdint>
#include <vector>

#include "grid_frame.h"

namespace navigation {

/// Two passes after Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions (2012):
/// down the columns, then the lower envelope of parabolas along each row. Linear in the cells;
/// about 10 ms for a million.
class Distances {
 public:
  /// Squared distances from this on are all the same.
  static constexpr std::uint16_t kFar = 65'025;  // 255 cells

  /// Makes room for maps of so many cells. [factory]
  explicit Distances(std::size_t cells = 0);
  /// For how many cells there is room. [rt]
  [[nodiscard]] std::size_t room() const { return squared_.size(); }
  /// From cells in which solid(index) holds; with `border`, cells outside are solid. There is room
  /// for the map. [rt]
  template <typename F>
  void measure(const Frame& frame, bool border, F&& solid) {
    for (std::size_t i = 0; i < frame.size(); ++i) squared_[i] = solid(i) ? 0 : kFar;
    measure(frame, border);
  }
  /// In square cells. [rt]
  [[nodiscard]] std::uint16_t squared(std::size_t index) const { return squared_[index]; }

 private:
  void measure(const Frame& frame, bool border);
  void down_the_columns(std::size_t width, std::size_t height, bool border);
  void along_the_row(std::uint16_t* row, int width, bool border);

  std::vector<std::uint16_t> squared_;
  std::vector<std::int32_t> above_;   // squared distance in the column, of the row at hand
  std::vector<std::int32_t> apex_;    // columns of the parabolas of the envelope
  std::vector<std::int32_t> begins_;  // where each begins to be the lowest
};

}  // namespace navigation
