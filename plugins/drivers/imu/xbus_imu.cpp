// SPDX-License-Identifier: LGPL-3.0-or-later
#include "xbus_imu.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "../../types/pose.h"
#include "xbus_frame.h"

namespace drivers {
namespace {

constexpr std::uint8_t kMtData2 = 0x36;
constexpr std::uint16_t kSampleTime = 0x1060;
constexpr std::uint16_t kEuler = 0x2030;
constexpr std::uint16_t kAcceleration = 0x4020;
constexpr std::uint16_t kRateOfTurn = 0x8020;
constexpr std::uint16_t kStatus = 0xe020;
constexpr std::uint16_t kStatusByte = 0xe010;  // the lowest byte of that word
constexpr std::uint32_t kFilterValid = 0x02;
constexpr float kDegrees = static_cast<float>(std::numbers::pi / 180.0);

// Beyond the full scale of any MTi: damage that the checksum does not show.
constexpr float kFastest = 36.0F;    // rad/s
constexpr float kHardest = 200.0F;   // m/s^2
constexpr float kFarthest = 360.0F;  // deg

constexpr double kTick = 1e-4;      // s
constexpr double kDrift = 100e-6;   // how much the unit's clock may be slow
constexpr double kRestarted = 1.0;  // s from where a sample should be: another clock

std::uint32_t word_at(Bytes data, std::size_t at) {
  return static_cast<std::uint32_t>(data[at]) << 24U |
         static_cast<std::uint32_t>(data[at + 1]) << 16U |
         static_cast<std::uint32_t>(data[at + 2]) << 8U | data[at + 3];
}

float float_at(Bytes data, std::size_t at) { return std::bit_cast<float>(word_at(data, at)); }

std::uint32_t word(double value) { return std::bit_cast<std::uint32_t>(static_cast<float>(value)); }

}  // namespace

double SampleClock::time(std::uint32_t ticks, double now) {
  const double passed = static_cast<double>(ticks - ticks_) * kTick;  // also over its wrap
  ticks_ = ticks;
  sample_ += begun_ ? passed : 0.0;
  const double offset = now - sample_;
  if (!begun_ || std::abs(offset - offset_) > kRestarted) {
    begun_ = true;
    sample_ = 0.0;
    offset_ = now;
  } else {
    offset_ = std::min(offset_ + kDrift * passed, offset);
  }
  return sample_ + offset_;
}

/// The values of one message.
struct ImuReader::Sample {
  rover::Imu imu;
  bool rate = false;
  bool plausible = true;
  bool sizes = true;
  bool oriented = true;  // its filter reports that, or reports nothing
  bool timed = false;
  std::uint32_t ticks = 0;

  void item(std::uint16_t id, Bytes data) {
    const bool vector = id == kRateOfTurn || id == kAcceleration || id == kEuler;
    const bool scalar = id == kSampleTime || id == kStatus;
    const bool byte = id == kStatusByte;
    if (!vector && !scalar && !byte) return;
    if (data.size() != (vector ? 12U : byte ? 1U : 4U)) {
      sizes = false;
    } else if (byte) {
      oriented = (data[0] & kFilterValid) != 0;
    } else if (vector) {
      vector_item(id, float_at(data, 0), float_at(data, 4), float_at(data, 8));
    } else if (id == kStatus) {
      oriented = (word_at(data, 0) & kFilterValid) != 0;
    } else {
      timed = true;
      ticks = word_at(data, 0);
    }
  }

  void vector_item(std::uint16_t id, float x, float y, float z) {
    const float most = id == kRateOfTurn ? kFastest : id == kAcceleration ? kHardest : kFarthest;
    const auto within = [most](float value) { return std::abs(value) <= most; };  // no NaN is
    plausible = plausible && within(x) && within(y) && within(z);
    if (id == kRateOfTurn) {
      rate = true;
      imu.yaw_rate = z;
    } else if (id == kAcceleration) {
      imu.acceleration_x = x;
      imu.acceleration_y = y;
    } else {
      imu.has_heading = true;
      imu.heading = rover::wrap(z * kDegrees);
    }
  }
};

ImuReader::Event ImuReader::read(Bytes frame, double now) {
  if (frame[2] != kMtData2) return Event::ignored;
  Sample sample;
  for (Bytes data = xbus_data(frame); !data.empty();) {
    if (data.size() < 3 || data.size() < 3U + data[2]) return Event::malformed;
    sample.item(static_cast<std::uint16_t>(data[0] << 8U | data[1]), data.subspan(3, data[2]));
    data = data.subspan(3U + data[2]);
  }
  if (!sample.sizes) return Event::malformed;
  if (!sample.plausible) return Event::implausible;
  if (!sample.rate) return Event::ignored;
  imu_ = sample.imu;
  imu_.has_heading = imu_.has_heading && sample.oriented;
  imu_.time = sample.timed ? clock_.time(sample.ticks, now) : now;
  return Event::imu;
}

Bytes ImuWriter::compose(const rover::Imu& imu, std::uint32_t ticks) {
  size_ = XbusFormat::kHeader;
  item(kSampleTime, {ticks});
  if (imu.has_heading) item(kEuler, {0, 0, word(imu.heading / static_cast<double>(kDegrees))});
  constexpr double kGravity = 9.81;
  item(kAcceleration, {word(imu.acceleration_x), word(imu.acceleration_y), word(kGravity)});
  item(kRateOfTurn, {0, 0, word(imu.yaw_rate)});
  const std::span<std::uint8_t> frame(frame_.data(), size_ + 1);
  xbus_seal(frame, kMtData2);
  return frame;
}

void ImuWriter::item(std::uint16_t id, std::initializer_list<std::uint32_t> words) {
  const auto put = [this](std::uint32_t byte) {
    frame_[size_++] = static_cast<std::uint8_t>(byte & 0xffU);
  };
  put(id >> 8U);
  put(id);
  put(static_cast<std::uint32_t>(4 * words.size()));
  for (const std::uint32_t value : words) {
    for (unsigned shift = 32; shift > 0; shift -= 8) put(value >> (shift - 8));
  }
}

}  // namespace drivers
