// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which box stands in which column.
#include <algorithm>
#include <limits>
#include <utility>

#include "picture/layers.h"

namespace mauve::ctl {
namespace {

using Edge = std::pair<std::size_t, std::size_t>;

/// Puts boxes in a row so that few wires lead back (Eades, Lin and Smyth). Boxes without an
/// incoming wire come first, boxes without an outgoing wire last. If every remaining box has both,
/// the one with the largest surplus of outgoing wires comes next.
class Row {
 public:
  Row(std::size_t boxes, const std::vector<Edge>& edges)
      : placed_(boxes), place_(boxes), enter_(boxes), leave_(boxes), before_(boxes), after_(boxes) {
    for (const auto& [from, to] : edges) {
      ++leave_[from];
      ++enter_[to];
      after_[from].push_back(to);
      before_[to].push_back(from);
    }
  }

  std::vector<std::size_t> places(std::optional<std::size_t> begin) {
    std::size_t first = 0;
    if (begin) put(*begin, first++);
    std::size_t last = placed_.size();
    while (first < last) {
      if (const auto sink = find([](int enter, int leave) { return leave == 0 && enter > 0; })) {
        put(*sink, --last);
      } else {
        put(next_source(), first++);
      }
    }
    return place_;
  }

 private:
  template <typename Wanted>
  [[nodiscard]] std::optional<std::size_t> find(Wanted wanted) const {
    for (std::size_t box = 0; box < placed_.size(); ++box) {
      if (!placed_[box] && wanted(enter_[box], leave_[box])) return box;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t next_source() const {
    if (const auto source = find([](int enter, int /*leave*/) { return enter == 0; })) {
      return *source;
    }
    std::size_t best = 0;
    int most = std::numeric_limits<int>::min();
    for (std::size_t box = 0; box < placed_.size(); ++box) {
      if (placed_[box] || leave_[box] - enter_[box] <= most) continue;
      most = leave_[box] - enter_[box];
      best = box;
    }
    return best;
  }
  void put(std::size_t box, std::size_t place) {
    placed_[box] = true;
    place_[box] = place;
    for (const std::size_t other : after_[box]) --enter_[other];
    for (const std::size_t other : before_[box]) --leave_[other];
  }

  std::vector<bool> placed_;
  std::vector<std::size_t> place_;
  std::vector<int> enter_;  ///< wires from boxes that have no place yet
  std::vector<int> leave_;
  std::vector<std::vector<std::size_t>> before_;
  std::vector<std::vector<std::size_t>> after_;
};

/// Each as far to the left as its wires allow.
std::vector<std::size_t> leftmost(const std::vector<std::size_t>& order,
                                  const std::vector<Edge>& forward) {
  std::vector<std::size_t> column(order.size());
  for (const std::size_t box : order) {
    for (const auto& [from, to] : forward) {
      if (to == box) column[box] = std::max(column[box], column[from] + 1);
    }
  }
  return column;
}

/// From the last to the first: a box with more wires to the right goes right, so that few wires are
/// long.
void pull_right(const std::vector<std::size_t>& order, const std::vector<Edge>& forward,
                std::vector<std::size_t>& column) {
  for (auto box = order.rbegin(); box != order.rend(); ++box) {
    std::size_t nearest = std::numeric_limits<std::size_t>::max();
    int leave = 0;
    for (const auto& [from, to] : forward) {
      leave += (from == *box ? 1 : 0) - (to == *box ? 1 : 0);
      if (from == *box) nearest = std::min(nearest, column[to] - 1);
    }
    if (leave > 0 && nearest != std::numeric_limits<std::size_t>::max()) column[*box] = nearest;
  }
}

}  // namespace

std::vector<std::size_t> columns_of(std::size_t boxes, const std::vector<Wire>& wires,
                                    std::optional<std::size_t> begin) {
  std::vector<Edge> edges;
  for (const Wire& wire : wires) {
    if (wire.from != wire.to) edges.emplace_back(wire.from, wire.to);
  }
  const std::vector<std::size_t> place = Row(boxes, edges).places(begin);
  std::vector<std::size_t> order(boxes);
  for (std::size_t box = 0; box < boxes; ++box) order[place[box]] = box;
  std::erase_if(edges, [&](const Edge& edge) { return place[edge.first] > place[edge.second]; });
  std::vector<std::size_t> column = leftmost(order, edges);
  pull_right(order, edges, column);
  const auto first = std::min_element(column.begin(), column.end());
  const std::size_t shift = first == column.end() ? 0 : *first;
  for (std::size_t& one : column) one -= shift;
  return column;
}

}  // namespace mauve::ctl
