// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <map>
#include <utility>

#include "picture/layers_part.h"

namespace mauve::ctl {
namespace {

constexpr double kPass = 0.0;  // a wire has no height

/// Makes items and trunks of wires, one after the other.
class Splitter {
 public:
  Splitter(const std::vector<Box>& boxes, const std::vector<Wire>& wires,
           std::optional<std::size_t> first) {
    const auto columns = columns_of(boxes.size(), wires, first);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      part.items.push_back({i, columns[i], boxes[i].height, 0.0});
      part.columns = std::max(part.columns, columns[i] + 1);
    }
    for (const Wire& wire : wires) add(wire);
  }

  Part part;

 private:
  using Key = std::pair<std::size_t, std::size_t>;

  /// Wires that leave at the same place are one net.
  std::size_t net_of(const Wire& wire) {
    return nets_.try_emplace({wire.from, wire.from_y}, nets_.size()).first->second;
  }

  std::size_t trunk(std::size_t net, std::size_t channel, const End& feeder) {
    const auto [found, fresh] = trunks_.try_emplace(Key{net, channel}, part.trunks.size());
    if (fresh) part.trunks.push_back({net, channel, {feeder}});
    return found->second;
  }
  void end_at(std::size_t trunk, const End& end) {
    auto& ends = part.trunks[trunk].ends;
    const auto same = [&](const End& one) {
      return one.item == end.item && one.below == end.below && one.left == end.left;
    };
    if (std::none_of(ends.begin(), ends.end(), same)) ends.push_back(end);
  }
  /// Where the net passes the column, to the right or back to the left.
  std::size_t pass(std::size_t net, std::size_t column, bool back) {
    auto& passes = back ? back_ : forth_;
    const auto [found, fresh] = passes.try_emplace(Key{net, column}, part.items.size());
    if (fresh) part.items.push_back({std::nullopt, column, kPass, 0.0});
    return found->second;
  }

  void add(const Wire& wire) {
    const std::size_t net = net_of(wire);
    const std::size_t from = part.items[wire.from].column;
    const std::size_t to = part.items[wire.to].column;
    Part::Way way;
    way.trunks.push_back(trunk(net, from + 1, {wire.from, wire.from_y, true}));
    const bool back = to <= from;
    for (std::size_t column = from + 1; back ? column > to : column < to;) {
      if (back) --column;
      const std::size_t here = pass(net, column, back);
      end_at(way.trunks.back(), {here, 0.0, back});
      way.passes.push_back(here);
      way.trunks.push_back(trunk(net, back ? column : column + 1, {here, 0.0, !back}));
      if (!back) ++column;
    }
    end_at(way.trunks.back(), {wire.to, wire.to_y, false});
    part.ways.push_back(std::move(way));
  }

  std::map<std::pair<std::size_t, double>, std::size_t> nets_;
  std::map<Key, std::size_t> trunks_;
  std::map<Key, std::size_t> forth_;
  std::map<Key, std::size_t> back_;
};

}  // namespace

Part split(const std::vector<Box>& boxes, const std::vector<Wire>& wires,
           std::optional<std::size_t> first) {
  return std::move(Splitter(boxes, wires, first).part);
}

}  // namespace mauve::ctl
