// SPDX-License-Identifier: LGPL-3.0-or-later
/// SCIP 2.0 as a scanner speaks it, for the simulated one and for tests. No heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "scip.h"

namespace drivers::scip {

/// Replies; each is valid until the next is composed. All of it is [rt].
class ReplyWriter {
 public:
  /// The echo of a request, at most kLongest long, a status of two characters, and nothing else.
  std::string_view reply(std::string_view echo, std::string_view status);
  /// In reply to PP.
  std::string_view limits(std::string_view echo, const Limits& limits);
  /// One scan; `steps` are all that were asked for, in millimetres. A value that is too large for
  /// its characters is cut to the largest.
  std::string_view scan(const Request& request, std::uint32_t stamp,
                        std::span<const std::uint32_t> steps);

 private:
  void add(std::string_view text);
  void add_summed(std::string_view text);
  void field(std::string_view name, int value);

  // The longest scan: 1081 values of 3 characters, 51 lines.
  std::array<char, 4096> buffer_{};
  std::size_t size_ = 0;
};

/// The measurement by a scanner with these limits of a LaserScan, one value a step. Nothing in
/// sight is `nothing`; a value that is no range is 0. Returns the number of steps. [rt]
std::size_t measure(const rover::LaserScan& scan, std::uint32_t nothing,
                    std::span<std::uint32_t> steps);
/// The limits of a scanner whose steps are the beams of the scan. [rt]
[[nodiscard]] Limits limits_of(const rover::LaserScan& scan, int turns_a_minute);

}  // namespace drivers::scip
