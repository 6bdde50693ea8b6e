// SPDX-License-Identifier: LGPL-3.0-or-later
/// The upright lines of a channel, side by side.
#include <algorithm>
#include <cmath>
#include <utility>

#include "picture/layers_part.h"

namespace mauve::ctl {
namespace {

constexpr double kSame = 3.0;           // pixels: nearer lines look like one
constexpr int kOnTopOfEachOther = 100;  // as bad as so many crossings

struct Span {
  double top = 0.0;
  double bottom = 0.0;

  [[nodiscard]] bool has(double y) const { return y > top - kSame && y < bottom + kSame; }
  [[nodiscard]] bool meets(const Span& other) const {
    return top < other.bottom + 2 * kSame && other.top < bottom + 2 * kSame;
  }
};

Span span_of(const Part& part, const Trunk& trunk) {
  Span span{part.y_of(trunk.ends.front()), part.y_of(trunk.ends.front())};
  for (const End& end : trunk.ends) {
    span.top = std::min(span.top, part.y_of(end));
    span.bottom = std::max(span.bottom, part.y_of(end));
  }
  return span;
}

/// The number of crossings when `a` runs to the left of `b`.
int crossings(const Part& part, const Trunk& a, const Trunk& b) {
  int count = 0;
  const Span of_a = span_of(part, a);
  const Span of_b = span_of(part, b);
  for (const End& end : a.ends) {
    if (!end.left && of_b.has(part.y_of(end))) ++count;
  }
  for (const End& end : b.ends) {
    if (end.left && of_a.has(part.y_of(end))) ++count;
  }
  for (const End& one : a.ends) {
    for (const End& other : b.ends) {
      const bool facing = !one.left && other.left;
      if (facing && std::abs(part.y_of(one) - part.y_of(other)) < kSame) count += kOnTopOfEachOther;
    }
  }
  return count;
}

/// Each goes where it crosses least among those that stand already; again until nothing changes.
std::vector<Trunk*> in_order(const Part& part, std::vector<Trunk*> all) {
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    bool better = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      Trunk* const one = all[i];
      std::size_t best = i;
      int gain = 0;
      for (const int step : {-1, 1}) {
        int sum = 0;
        for (auto k = static_cast<std::ptrdiff_t>(i) + step;
             k >= 0 && k < static_cast<std::ptrdiff_t>(all.size()); k += step) {
          Trunk* const other = all[static_cast<std::size_t>(k)];
          const int before = crossings(part, *one, *other);
          const int after = crossings(part, *other, *one);
          sum += step > 0 ? before - after : after - before;
          if (sum > gain) {
            gain = sum;
            best = static_cast<std::size_t>(k);
          }
        }
      }
      if (best == i) continue;
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(i));
      all.insert(all.begin() + static_cast<std::ptrdiff_t>(best), one);
      better = true;
    }
    if (!better) break;
  }
  return all;
}

/// Those that do not meet may share a track.
std::size_t give_tracks(const Part& part, const std::vector<Trunk*>& ordered) {
  std::size_t tracks = 0;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    std::size_t track = 0;
    for (std::size_t k = 0; k < i; ++k) {
      if (!span_of(part, *ordered[i]).meets(span_of(part, *ordered[k]))) continue;
      track = std::max(track, static_cast<std::size_t>(ordered[k]->x) + 1);
    }
    ordered[i]->x = static_cast<double>(track);
    tracks = std::max(tracks, track + 1);
  }
  return tracks;
}

}  // namespace

std::vector<std::size_t> place_trunks(Part& part) {
  std::vector<std::size_t> tracks;
  for (std::size_t channel = 0; channel <= part.columns; ++channel) {
    std::vector<Trunk*> all;
    for (Trunk& trunk : part.trunks) {
      const Span span = span_of(part, trunk);
      if (trunk.channel == channel && span.bottom - span.top > kSame) all.push_back(&trunk);
    }
    tracks.push_back(give_tracks(part, in_order(part, std::move(all))));
  }
  return tracks;
}

}  // namespace mauve::ctl
