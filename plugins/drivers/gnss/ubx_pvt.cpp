// SPDX-License-Identifier: LGPL-3.0-or-later
#include "ubx_pvt.h"

#include <cmath>
#include <cstddef>

#include "ubx_frame.h"

namespace drivers {
namespace {

using rover::GnssFix;

constexpr std::uint8_t kNav = 0x01;
constexpr std::uint8_t kPvt = 0x07;
constexpr double kDay = 86'400.0;

// Offsets in the payload.
constexpr std::size_t kHour = 8;
constexpr std::size_t kMinute = 9;
constexpr std::size_t kSecond = 10;
constexpr std::size_t kValid = 11;
constexpr std::size_t kNano = 16;
constexpr std::size_t kFixType = 20;
constexpr std::size_t kFlags = 21;
constexpr std::size_t kSatellites = 23;
constexpr std::size_t kLongitude = 24;
constexpr std::size_t kLatitude = 28;
constexpr std::size_t kHeight = 32;    // above the ellipsoid
constexpr std::size_t kAltitude = 36;  // above mean sea level
constexpr std::size_t kPdop = 76;
constexpr std::size_t kFlags3 = 78;  // of the longer message

constexpr unsigned kValidTime = 0x02;
constexpr unsigned kFixOk = 0x01;
constexpr unsigned kInvalidPosition = 0x01;

std::uint32_t unsigned_at(Bytes payload, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i > 0; --i) value = value << 8U | payload[at + i - 1];
  return value;
}

double signed_at(Bytes payload, std::size_t at) {
  return static_cast<double>(static_cast<std::int32_t>(unsigned_at(payload, at, 4)));
}

/// Seconds of the day; the nanoseconds may take it below midnight. Nothing when it cannot be.
std::optional<double> time_of(Bytes payload) {
  if ((payload[kValid] & kValidTime) == 0) return 0.0;
  const double nano = signed_at(payload, kNano);
  if (payload[kHour] > 23 || payload[kMinute] > 59 || payload[kSecond] > 60) return {};
  if (std::abs(nano) > 1e9) return {};
  const double time =
      payload[kHour] * 3600.0 + payload[kMinute] * 60.0 + payload[kSecond] + nano * 1e-9;
  return time < 0.0 ? time + kDay : time;
}

/// 2 and 3 as in NMEA; a position by dead reckoning alone, or one the receiver does not vouch for,
/// is none.
std::int32_t mode_of(Bytes payload) {
  const bool vouched = (payload[kFlags] & kFixOk) != 0 &&
                       (payload.size() < 92 || (payload[kFlags3] & kInvalidPosition) == 0);
  if (!vouched || payload[kSatellites] == 0) return 1;
  const unsigned type = payload[kFixType];
  return type == 2 ? 2 : type == 3 || type == 4 ? 3 : 1;
}

}  // namespace

bool is_pvt(Bytes frame) { return frame[2] == kNav && frame[3] == kPvt; }

std::optional<GnssFix> read_pvt(Bytes frame) {
  const Bytes payload = ubx_payload(frame);
  if (payload.size() != 84 && payload.size() != 92) return {};
  const auto time = time_of(payload);
  const double latitude = signed_at(payload, kLatitude) * 1e-7;
  const double longitude = signed_at(payload, kLongitude) * 1e-7;
  if (!time || std::abs(latitude) > 90.0 || std::abs(longitude) > 180.0) return {};
  GnssFix fix;
  fix.time = *time;
  fix.hdop = unsigned_at(payload, kPdop, 2) * 0.01;
  fix.satellites = payload[kSatellites];
  fix.mode = mode_of(payload);
  if (fix.mode == 1) return fix;
  fix.latitude = latitude;
  fix.longitude = longitude;
  fix.altitude = signed_at(payload, kAltitude) * 1e-3;
  return fix;
}

double pvt_separation(Bytes frame) {
  const Bytes payload = ubx_payload(frame);
  return (signed_at(payload, kHeight) - signed_at(payload, kAltitude)) * 1e-3;
}

std::array<std::uint8_t, 100> write_pvt(const GnssFix& fix) {
  std::array<std::uint8_t, 100> frame{};
  const auto put = [&](std::size_t at, double value, std::size_t size) {
    auto rest = static_cast<std::uint64_t>(std::llround(value));
    for (std::size_t i = 0; i < size; ++i, rest >>= 8U) {
      frame[UbxFormat::kHeader + at + i] = static_cast<std::uint8_t>(rest & 0xffU);
    }
  };
  const double whole = std::floor(fix.time);
  const double day = std::fmod(whole, kDay);
  put(kHour, std::floor(day / 3600.0), 1);
  put(kMinute, std::floor(std::fmod(day, 3600.0) / 60.0), 1);
  put(kSecond, std::fmod(day, 60.0), 1);
  put(kValid, kValidTime, 1);
  put(kNano, (fix.time - whole) * 1e9, 4);
  put(kFixType, fix.mode > 1 ? fix.mode : 0, 1);
  put(kFlags, fix.mode > 1 ? kFixOk : 0, 1);
  put(kSatellites, fix.satellites, 1);
  put(kLongitude, fix.longitude * 1e7, 4);
  put(kLatitude, fix.latitude * 1e7, 4);
  put(kHeight, fix.altitude * 1e3, 4);
  put(kAltitude, fix.altitude * 1e3, 4);
  put(kPdop, fix.hdop * 100.0, 2);
  ubx_seal(frame, kNav, kPvt);
  return frame;
}

}  // namespace drivers
