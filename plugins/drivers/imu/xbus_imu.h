// SPDX-License-Identifier: LGPL-3.0-or-later
/// MTData2, one measurement of an Xsens MTi, as imu/1 and back. Source: as xbus_frame.h, chapter
/// "MTData2". Understood are single-precision values in the frame "ENU" (x forward, z up): rate of
/// turn 0x8020, acceleration 0x4020, Euler angles 0x2030; and sample time 0x1060, status 0xE020 or
/// 0xE010.
#pragma once

#include <array>
#include <cstdint>

#include "../../types/imu.h"
#include "../serial/binary_frame.h"

namespace drivers {

/// The unit's clock, ticks of 0.1 ms, in our time. A late arrival is no late measurement: the
/// quickest way of a measurement to us counts for all. [rt]
class SampleClock {
 public:
  /// When the sample was measured, s; `now` is when it came.
  double time(std::uint32_t ticks, double now);

 private:
  bool begun_ = false;
  std::uint32_t ticks_ = 0;
  double sample_ = 0.0;  // s since the first
  double offset_ = 0.0;  // from there to our clock
};

/// Reads measurements. All of it is [rt].
class ImuReader {
 public:
  enum class Event : std::uint8_t {
    ignored,      ///< no rate of turn
    imu,          ///< a measurement: see imu()
    malformed,    ///< right checksum, but lengths that cannot be
    implausible,  ///< a value is no number, or beyond the range of any unit
  };

  /// `now` in seconds of the monotonic clock.
  Event read(Bytes frame, double now);
  [[nodiscard]] const rover::Imu& imu() const { return imu_; }

 private:
  struct Sample;

  rover::Imu imu_;
  SampleClock clock_;
};

/// The frame of one measurement, for the simulated unit; its heading only with has_heading. `ticks`
/// of 0.1 ms. [rt]
class ImuWriter {
 public:
  Bytes compose(const rover::Imu& imu, std::uint32_t ticks);

 private:
  void item(std::uint16_t id, std::initializer_list<std::uint32_t> words);

  std::array<std::uint8_t, 64> frame_{};
  std::size_t size_ = 0;
};

}  // namespace drivers
