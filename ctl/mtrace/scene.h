// SPDX-License-Identifier: LGPL-3.0-or-later
/// The content of a timeline, before it is a picture: a window, rows, and pieces of execution.
#pragma once

#include <string>
#include <vector>

#include "mtrace/lanes.h"
#include "mtrace/timeline.h"

namespace mauve::ctl::mtrace {

enum class Piece : std::uint8_t {
  runs,       ///< an execution state
  job,        ///< a job, its states not drawn apart
  many,       ///< jobs too close to be drawn apart
  preempted,  ///< a more urgent one had the processor
  blocked,    ///< waited for a lock
};

struct Box {
  Piece piece = Piece::runs;
  std::int64_t from = 0;
  std::int64_t to = 0;
  Word state = 0;            ///< of `runs`, and of the two that interrupt it
  const Job* job = nullptr;  ///< that it is part of; null: not known
  std::uint64_t count = 1;   ///< of `many`
};

struct Row {
  const Lane* lane = nullptr;
  std::vector<Box> boxes;
  bool dense = false;  ///< too much for single boxes and arrows
};

struct Scene {
  std::vector<Lane> lanes;
  std::vector<Row> rows;
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::vector<std::string> left_out;
  std::size_t without_arrows = 0;  ///< rows whose releases are too many
};

/// At most so many boxes in all rows together.
inline constexpr std::size_t kMostBoxes = 4000;
inline constexpr std::size_t kMostRows = 32;

/// Chooses window and rows. `smallest`: share of the window that is worth a box of its own.
[[nodiscard]] Scene scene_of(const Trace& trace, const View& view, double smallest);

}  // namespace mauve::ctl::mtrace
