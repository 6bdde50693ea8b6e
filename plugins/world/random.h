// SPDX-License-Identifier: LGPL-3.0-or-later
/// Random numbers that are the same on every machine for the same seed (splitmix64).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace world {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// Even in [low, high). [rt]
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11U) * 0x1.0p-53;
  }
  /// Normal with mean 0. [rt]
  double normal(double deviation) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return deviation * radius * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

}  // namespace world
