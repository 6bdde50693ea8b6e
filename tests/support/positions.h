// SPDX-License-Identifier: LGPL-3.0-or-later
/// Cores for the ramp of ramp.h whose states are of three revisions, and their output.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "support/ramp.h"

namespace ramp {

/// Revision 1 counts in metres, 2 in millimetres, 3 has all the room that a conversion may take.
struct PositionV1 {
  double metres = 0;
  std::int64_t jobs = 0;
};
struct PositionV2 {
  std::int64_t jobs = 0;
  std::int64_t millimetres = 0;
};
struct PositionV3 {
  std::array<double, 510> table{};
  double metres = 0;
  std::int64_t jobs = 0;
};
static_assert(sizeof(PositionV3) == mauve::kMaxConverted);

/// Made by an author who forgot to raise the revision.
struct ChangedV1 {
  std::int64_t jobs = 0;
  double metres = 0;
};

}  // namespace ramp

template <>
struct mauve::Described<ramp::PositionV1> {
  static constexpr std::string_view name = "ramp_position/1";
  static constexpr auto fields() {
    return std::tuple{field("metres", &ramp::PositionV1::metres, "m"),
                      field("jobs", &ramp::PositionV1::jobs)};
  }
};
template <>
struct mauve::Described<ramp::PositionV2> {
  static constexpr std::string_view name = "ramp_position/2";
  static constexpr auto fields() {
    return std::tuple{field("jobs", &ramp::PositionV2::jobs),
                      field("millimetres", &ramp::PositionV2::millimetres, "mm")};
  }
};
template <>
struct mauve::Described<ramp::PositionV3> {
  static constexpr std::string_view name = "ramp_position/3";
  static constexpr auto fields() {
    return std::tuple{field("table", &ramp::PositionV3::table),
                      field("metres", &ramp::PositionV3::metres, "m"),
                      field("jobs", &ramp::PositionV3::jobs)};
  }
};
template <>
struct mauve::Described<ramp::ChangedV1> {
  static constexpr std::string_view name = "ramp_position/1";
  static constexpr auto fields() {
    return std::tuple{field("jobs", &ramp::ChangedV1::jobs),
                      field("metres", &ramp::ChangedV1::metres, "m")};
  }
};

namespace ramp {

inline double metres_of(const PositionV1& position) { return position.metres; }
inline double metres_of(const PositionV2& position) {
  return static_cast<double>(position.millimetres) / 1000;
}
inline double metres_of(const PositionV3& position) { return position.metres; }
inline double metres_of(const ChangedV1& position) { return position.metres; }
inline void put(double metres, PositionV1& into) { into.metres = metres; }
inline void put(double metres, PositionV2& into) {
  into.millimetres = static_cast<std::int64_t>(metres * 1000);
}
inline void put(double metres, PositionV3& into) { into.metres = metres; }
inline void put(double metres, ChangedV1& into) { into.metres = metres; }

/// The converter between any two revisions.
template <typename Old, typename Now>
void convert(const Old& old, Now& now) noexcept {
  put(metres_of(old), now);
  now.jobs = old.jobs;
}

/// Every value that a mover wrote, in this process. Of one thread: simulated deployments only.
inline std::vector<double>& written() {
  static std::vector<double> values;
  return values;
}

/// Moves by `Step` each job and counts its jobs.
template <typename Position, int Step>
class Mover : public RampCore {
 public:
  mauve::State<Position> state{*this};

  void update() override {
    put(metres_of(*state) + Step, *state);
    ++state->jobs;
    written().push_back(metres_of(*state));
    shell().out.write(metres_of(*state));
  }
};

/// Knows no other revision.
template <typename Position, int Step = 1>
class Lone final : public Mover<Position, Step> {};

/// Converts from two others.
template <typename Position, int Step, typename One, typename Two>
class Converting final : public Mover<Position, Step> {
 public:
  mauve::Converts<One, Position> from_one{this->state, convert<One, Position>};
  mauve::Converts<Two, Position> from_two{this->state, convert<Two, Position>};
};

using First = Converting<PositionV1, 1, PositionV2, PositionV3>;
using Second = Converting<PositionV2, -1, PositionV3, PositionV1>;
using Third = Converting<PositionV3, 1, PositionV1, PositionV2>;

}  // namespace ramp
