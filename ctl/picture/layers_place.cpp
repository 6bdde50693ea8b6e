// SPDX-License-Identifier: LGPL-3.0-or-later
/// Barycentres for the order, then the least change of all heights that keeps it.
#include <algorithm>
#include <cmath>
#include <limits>

#include "picture/layers_part.h"

namespace mauve::ctl {
namespace {

constexpr int kSweeps = 24;
constexpr int kPolishing = 12;
constexpr double kBetweenBoxes = 22.0;
constexpr double kBesideWire = 14.0;
constexpr double kCrossing = 300.0;  // as bad as so many pixels of wire

/// One piece of wire as an item sees it.
struct Pull {
  std::size_t other = 0;
  double distance = 0.0;  ///< y of the item is best at y of the other plus this
  double weight = 1.0;
  std::size_t column = 0;  ///< of the other
};

class Placing {
 public:
  explicit Placing(Part& part) : part_(part), pulls_(part.items.size()), order_(part.columns) {
    for (std::size_t i = 0; i < part.items.size(); ++i) order_[part.items[i].column].push_back(i);
    for (const Trunk& trunk : part.trunks) {
      for (std::size_t i = 1; i < trunk.ends.size(); ++i) pull(trunk.ends[0], trunk.ends[i]);
    }
    for (auto& column : order_) pack(column, {});
  }

  void run() {
    std::vector<double> best = heights();
    double least = cost();
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t i = 0; i < order_.size(); ++i) {
        const std::size_t column = sweep % 2 == 0 ? i : order_.size() - 1 - i;
        settle(column, sweep % 2 == 0 ? Side::left : Side::right, true);
      }
      for (std::size_t i = 0; i < order_.size(); ++i) settle(i, Side::both, false);
      if (const double now = cost(); now < least) {
        least = now;
        best = heights();
      }
    }
    restore(best);
    for (int i = 0; i < kPolishing; ++i) {
      for (std::size_t k = 0; k < order_.size(); ++k) {
        settle(i % 2 == 0 ? k : order_.size() - 1 - k, Side::both, false);
      }
    }
    straighten();
  }

 private:
  enum class Side { left, right, both };

  void pull(const End& a, const End& b) {
    const auto passes = [&](const End& end) { return part_.items[end.item].box ? 0 : 1; };
    const double weight = passes(a) + passes(b) == 2 ? 5.0 : 1.0 + passes(a) + passes(b);
    pulls_[a.item].push_back({b.item, b.below - a.below, weight, part_.items[b.item].column});
    pulls_[b.item].push_back({a.item, a.below - b.below, weight, part_.items[a.item].column});
  }

  [[nodiscard]] double wanted(std::size_t item, Side side) const {
    double sum = 0.0;
    double weight = 0.0;
    const std::size_t here = part_.items[item].column;
    for (const Pull& one : pulls_[item]) {
      if (side == Side::left && one.column > here) continue;
      if (side == Side::right && one.column < here) continue;
      sum += one.weight * (part_.items[one.other].y + one.distance);
      weight += one.weight;
    }
    return weight > 0.0 ? sum / weight : part_.items[item].y;
  }

  void settle(std::size_t column, Side side, bool reorder) {
    std::vector<std::size_t>& items = order_[column];
    std::vector<double> best(part_.items.size());
    for (const std::size_t item : items) best[item] = wanted(item, side);
    if (reorder) {
      const auto middle = [&](std::size_t item) {
        return best[item] + part_.items[item].height / 2.0;
      };
      std::stable_sort(items.begin(), items.end(),
                       [&](std::size_t a, std::size_t b) { return middle(a) < middle(b); });
    }
    pack(items, best);
  }

  /// A wire that passes several columns goes on as high as it comes, where there is room: else it
  /// would climb in steps.
  void straighten() {
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 0; i < part_.trunks.size(); ++i) {
        const Trunk& trunk = part_.trunks[i];
        for (std::size_t k = 1; k < trunk.ends.size(); ++k) {
          const std::size_t item = trunk.ends[k].item;
          if (!part_.items[item].box) move(item, part_.y_of(trunk.ends.front()));
        }
      }
    }
  }
  /// As far as its neighbours in the column let it.
  void move(std::size_t item, double y) {
    const auto& column = order_[part_.items[item].column];
    const auto here = std::find(column.begin(), column.end(), item);
    if (here != column.begin()) {
      const std::size_t above = *std::prev(here);
      y = std::max(y, part_.items[above].y + part_.items[above].height + gap(above, item));
    }
    if (std::next(here) != column.end()) {
      const std::size_t below = *std::next(here);
      y = std::min(y, part_.items[below].y - gap(item, below));
    }
    part_.items[item].y = y;
  }

  [[nodiscard]] double gap(std::size_t above, std::size_t below) const {
    const bool boxes = part_.items[above].box && part_.items[below].box;
    return boxes ? kBetweenBoxes : kBesideWire;
  }

  /// As near as possible to the wanted places, in this order and apart: blocks of items that touch
  /// are joined until none overlaps the next (isotonic regression).
  void pack(const std::vector<std::size_t>& items, const std::vector<double>& best) {
    struct Block {
      double sum;
      double count;
      std::size_t size;
    };
    std::vector<Block> blocks;
    std::vector<double> shift(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (i > 0) {
        shift[i] = shift[i - 1] + part_.items[items[i - 1]].height + gap(items[i - 1], items[i]);
      }
      const double want = (best.empty() ? 0.0 : best[items[i]]) - shift[i];
      blocks.push_back({want, 1.0, 1});
      while (blocks.size() > 1) {
        const Block last = blocks.back();
        Block& before = blocks[blocks.size() - 2];
        if (before.sum / before.count < last.sum / last.count) break;
        before = {before.sum + last.sum, before.count + last.count, before.size + last.size};
        blocks.pop_back();
      }
    }
    std::size_t i = 0;
    for (const Block& block : blocks) {
      for (std::size_t k = 0; k < block.size; ++k, ++i) {
        part_.items[items[i]].y = block.sum / block.count + shift[i];
      }
    }
  }

  /// Crossings of pieces of wire in all channels, and their heights.
  [[nodiscard]] double cost() const {
    struct Piece {
      std::size_t net;
      double from;
      double to;
    };
    double total = 0.0;
    for (std::size_t channel = 0; channel <= part_.columns; ++channel) {
      std::vector<Piece> pieces;
      for (const Trunk& trunk : part_.trunks) {
        if (trunk.channel != channel) continue;
        const End& feeder = trunk.ends.front();
        for (std::size_t i = 1; i < trunk.ends.size(); ++i) {
          const double from = part_.y_of(feeder);
          const double to = part_.y_of(trunk.ends[i]);
          total += std::abs(from - to);
          if (feeder.left == trunk.ends[i].left) continue;
          pieces.push_back({trunk.net, feeder.left ? from : to, feeder.left ? to : from});
        }
      }
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        for (std::size_t k = i + 1; k < pieces.size(); ++k) {
          const Piece& a = pieces[i];
          const Piece& b = pieces[k];
          if (a.net != b.net && (a.from - b.from) * (a.to - b.to) < 0.0) total += kCrossing;
        }
      }
    }
    return total;
  }

  [[nodiscard]] std::vector<double> heights() const {
    std::vector<double> all;
    for (const Item& item : part_.items) all.push_back(item.y);
    return all;
  }
  void restore(const std::vector<double>& heights) {
    for (std::size_t i = 0; i < heights.size(); ++i) part_.items[i].y = heights[i];
    for (auto& column : order_) {
      std::stable_sort(column.begin(), column.end(), [&](std::size_t a, std::size_t b) {
        return part_.items[a].y < part_.items[b].y;
      });
    }
  }

  Part& part_;
  std::vector<std::vector<Pull>> pulls_;
  std::vector<std::vector<std::size_t>> order_;  ///< of each column, from above
};

}  // namespace

void place_items(Part& part) { Placing(part).run(); }

}  // namespace mauve::ctl
