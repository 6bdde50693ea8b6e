// SPDX-License-Identifier: LGPL-3.0-or-later
/// One connected part of a picture of boxes and wires: the items in its columns, and their places.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "picture/layers.h"

namespace mauve::ctl {

/// A box, or the place where a wire passes a column.
struct Item {
  std::optional<std::size_t> box;
  std::size_t column = 0;
  double height = 0.0;
  double y = 0.0;
};

/// An end of a piece of wire: so far below the top of an item.
struct End {
  std::size_t item = 0;
  double below = 0.0;
  bool left = false;  ///< of the channel: at the right side of the item
};

/// The pieces of one net in one channel, the space before a column: from one end to all others.
struct Trunk {
  std::size_t net = 0;
  std::size_t channel = 0;
  std::vector<End> ends;  ///< the first one feeds the others
  double x = 0.0;
};

struct Part {
  std::size_t columns = 0;
  std::vector<Item> items;  ///< boxes first, by their numbers
  std::vector<Trunk> trunks;
  /// Of each wire: its ends and the trunks on its way, as indices into `trunks`.
  struct Way {
    std::vector<std::size_t> trunks;
    std::vector<std::size_t> passes;  ///< items between them, one less
  };
  std::vector<Way> ways;

  [[nodiscard]] double y_of(const End& end) const { return items[end.item].y + end.below; }
};

/// Items and trunks; nothing has a place yet.
[[nodiscard]] Part split(const std::vector<Box>& boxes, const std::vector<Wire>& wires,
                         std::optional<std::size_t> first);
/// Orders the items of each column so that few wires cross, and gives them their y.
void place_items(Part& part);
/// Where in its channel each trunk runs: so many tracks from the left. Returns the tracks of each
/// channel.
[[nodiscard]] std::vector<std::size_t> place_trunks(Part& part);

}  // namespace mauve::ctl
