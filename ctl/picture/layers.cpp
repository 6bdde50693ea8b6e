// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/layers.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "picture/layers_part.h"

namespace mauve::ctl {
namespace {

constexpr double kTrack = 11.0;      // between upright lines
constexpr double kBesideBox = 22.0;  // from a box to the first of them
constexpr double kBetweenParts = 34.0;
constexpr double kUsualWidth = 900.0;

/// Which boxes wires connect.
std::vector<std::vector<std::size_t>> parts_of(std::size_t boxes, const std::vector<Wire>& wires) {
  std::vector<std::size_t> part(boxes);
  for (std::size_t i = 0; i < boxes; ++i) part[i] = i;
  for (const Wire& wire : wires) {
    const std::size_t from = part[wire.from];
    const std::size_t to = part[wire.to];
    std::replace(part.begin(), part.end(), std::max(from, to), std::min(from, to));
  }
  std::vector<std::vector<std::size_t>> parts(boxes);
  for (std::size_t i = 0; i < boxes; ++i) parts[part[i]].push_back(i);
  std::erase_if(parts, [](const auto& one) { return one.empty(); });
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

/// Left edges of columns, and of the channels before them.
struct ColumnGrid {
  std::vector<double> columns;
  std::vector<double> widths;
  std::vector<double> channels;
  double width = 0.0;
};

ColumnGrid grid_of(const Part& part, const std::vector<Box>& boxes,
                   const std::vector<std::size_t>& tracks) {
  ColumnGrid grid;
  grid.widths.resize(part.columns);
  for (const Item& item : part.items) {
    if (item.box)
      grid.widths[item.column] = std::max(grid.widths[item.column], boxes[*item.box].width);
  }
  double x = 0.0;
  for (std::size_t i = 0; i <= part.columns; ++i) {
    const bool outside = i == 0 || i == part.columns;
    const double lines = static_cast<double>(tracks[i]);
    grid.channels.push_back(x + kBesideBox);
    if (!outside || tracks[i] > 0) x += 2 * kBesideBox + std::max(0.0, lines - 1.0) * kTrack;
    if (i == part.columns) break;
    grid.columns.push_back(x);
    x += grid.widths[i];
  }
  grid.width = x;
  return grid;
}

/// Without the places that lie on a straight line.
std::vector<Place> straightened(const std::vector<Place>& route) {
  std::vector<Place> kept;
  for (const Place& place : route) {
    if (!kept.empty() && std::hypot(kept.back().x - place.x, kept.back().y - place.y) < 0.05)
      continue;
    const std::size_t size = kept.size();
    const auto on_line = [&](double a, double b, double c) {
      return std::abs(a - b) < 0.05 && std::abs(b - c) < 0.05;
    };
    if (size > 1 && (on_line(kept[size - 2].x, kept[size - 1].x, place.x) ||
                     on_line(kept[size - 2].y, kept[size - 1].y, place.y))) {
      kept.back() = place;
    } else {
      kept.push_back(place);
    }
  }
  return kept;
}

std::vector<Place> route_of(const Part& part, const Part::Way& way, const ColumnGrid& grid,
                            const Wire& wire) {
  const Item& from = part.items[wire.from];
  const Item& to = part.items[wire.to];
  double y = from.y + wire.from_y;
  std::vector<Place> route{{grid.columns[from.column] + grid.widths[from.column], y}};
  for (std::size_t i = 0; i < way.trunks.size(); ++i) {
    const Trunk& trunk = part.trunks[way.trunks[i]];
    const double x = grid.channels[trunk.channel] + trunk.x * kTrack;
    route.push_back({x, y});
    y = i < way.passes.size() ? part.items[way.passes[i]].y : to.y + wire.to_y;
    route.push_back({x, y});
  }
  route.push_back({grid.columns[to.column], y});
  return straightened(route);
}

/// Where lines leave an upright one in at least three directions.
void add_joints(const Part& part, const Trunk& trunk, double x, std::vector<Place>& joints) {
  for (const End& end : trunk.ends) {
    const double y = part.y_of(end);
    bool up = false;
    bool down = false;
    bool left = false;
    bool right = false;
    for (const End& other : trunk.ends) {
      const double away = part.y_of(other) - y;
      up = up || away < -1.0;
      down = down || away > 1.0;
      const bool beside = std::abs(away) < 1.0;
      (other.left ? left : right) = (other.left ? left : right) || beside;
    }
    if (up + down + left + right >= 3) joints.push_back({x, y});
  }
}

/// All of it with its upper left corner at the origin.
Arrangement arrange_part(const std::vector<Box>& boxes, const std::vector<Wire>& wires,
                         std::optional<std::size_t> first) {
  Part part = split(boxes, wires, first);
  place_items(part);
  const ColumnGrid grid = grid_of(part, boxes, place_trunks(part));
  Arrangement all;
  double top = 0.0;
  for (std::size_t i = 0; i < part.items.size(); ++i) {
    top = i == 0 ? part.items[i].y : std::min(top, part.items[i].y);
  }
  for (Item& item : part.items) {
    item.y -= top;
    all.height = std::max(all.height, item.y + item.height);
    if (!item.box) continue;
    all.corners.push_back({grid.columns[item.column], item.y});
    all.widths.push_back(grid.widths[item.column]);
  }
  for (std::size_t i = 0; i < wires.size(); ++i) {
    all.routes.push_back(route_of(part, part.ways[i], grid, wires[i]));
  }
  for (const Trunk& trunk : part.trunks) {
    add_joints(part, trunk, grid.channels[trunk.channel] + trunk.x * kTrack, all.joints);
  }
  all.width = grid.width;
  return all;
}

/// Side by side below each other, as text runs.
class Page {
 public:
  Place room_for(const Arrangement& part, double width) {
    if (x_ > 0.0 && x_ + part.width > width) {
      y_ += line_ + kBetweenParts;
      x_ = line_ = 0.0;
    }
    const Place corner{x_, y_};
    x_ += part.width + kBetweenParts;
    line_ = std::max(line_, part.height);
    right_ = std::max(right_, corner.x + part.width);
    return corner;
  }
  [[nodiscard]] double width() const { return right_; }
  [[nodiscard]] double height() const { return y_ + line_; }

 private:
  double x_ = 0.0;
  double y_ = 0.0;
  double line_ = 0.0;
  double right_ = 0.0;
};

}  // namespace

Arrangement arrange(const std::vector<Box>& boxes, const std::vector<Wire>& wires,
                    std::optional<std::size_t> first) {
  Arrangement all;
  all.corners.resize(boxes.size());
  all.widths.resize(boxes.size());
  all.routes.resize(wires.size());
  Page page;
  std::vector<std::size_t> place(boxes.size());
  for (const auto& members : parts_of(boxes.size(), wires)) {
    std::vector<Box> own_boxes;
    std::vector<bool> is_member(boxes.size());
    for (const std::size_t box : members) {
      place[box] = own_boxes.size();
      is_member[box] = true;
      own_boxes.push_back(boxes[box]);
    }
    std::vector<Wire> own_wires;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < wires.size(); ++i) {
      if (!is_member[wires[i].from]) continue;
      own_wires.push_back(
          {place[wires[i].from], wires[i].from_y, place[wires[i].to], wires[i].to_y});
      numbers.push_back(i);
    }
    const bool has_first = first && is_member[*first];
    Arrangement part =
        arrange_part(own_boxes, own_wires, has_first ? std::optional(place[*first]) : std::nullopt);
    const Place corner = page.room_for(part, std::max(page.width(), kUsualWidth));
    const auto moved = [&](const Place& one) { return Place{one.x + corner.x, one.y + corner.y}; };
    for (std::size_t i = 0; i < members.size(); ++i) {
      all.corners[members[i]] = moved(part.corners[i]);
      all.widths[members[i]] = part.widths[i];
    }
    std::transform(part.joints.begin(), part.joints.end(), std::back_inserter(all.joints), moved);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      std::transform(part.routes[i].begin(), part.routes[i].end(), part.routes[i].begin(), moved);
      all.routes[numbers[i]] = std::move(part.routes[i]);
    }
  }
  all.width = page.width();
  all.height = page.height();
  return all;
}

}  // namespace mauve::ctl
