// SPDX-License-Identifier: LGPL-3.0-or-later
#include "nmea_write.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace drivers {
namespace {

constexpr double kKnotsPerMetreASecond = 3600.0 / 1852.0;

std::size_t scaled(double value, int decimals) {
  return static_cast<std::size_t>(std::llround(std::abs(value) * std::pow(10.0, decimals)));
}

}  // namespace

std::string_view NmeaWriter::compose(const rover::GnssFix& fix, double speed, double course) {
  size_ = 0;
  begin("GPGGA,");
  time_of_day(fix.time);
  position(fix);
  text(fix.mode > 1 ? ",1," : ",0,");
  digits(static_cast<std::size_t>(fix.satellites), 2);
  text(",");
  decimal(fix.hdop, 1, 2);
  text(",");
  if (fix.mode == 3) decimal(fix.altitude, 1, 2);
  text(",M,,M,,");
  end();
  begin("GPGSA,A,");
  digits(static_cast<std::size_t>(fix.mode), 1);
  text(",,,,,,,,,,,,,,");
  decimal(fix.hdop, 1, 2);
  text(",");
  end();
  begin("GPRMC,");
  time_of_day(fix.time);
  text(fix.mode > 1 ? ",A" : ",V");
  position(fix);
  text(",");
  decimal(speed * kKnotsPerMetreASecond, 1, 2);
  text(",");
  decimal(course, 1, 1);
  text(",010126,,,A");
  end();
  return {buffer_.data(), size_};
}

void NmeaWriter::begin(std::string_view address) {
  text("$");
  start_ = size_;
  text(address);
}

void NmeaWriter::end() {
  std::uint8_t sum = 0;
  for (std::size_t i = start_; i < size_; ++i) {
    sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(buffer_[i]));
  }
  constexpr std::string_view kHex = "0123456789ABCDEF";
  text("*");
  text(kHex.substr(sum / 16U, 1));
  text(kHex.substr(sum % 16U, 1));
  text("\r\n");
}

void NmeaWriter::text(std::string_view piece) {
  const std::size_t fits = std::min(piece.size(), buffer_.size() - size_);
  std::copy_n(piece.data(), fits, buffer_.data() + size_);
  size_ += fits;
}

void NmeaWriter::digits(std::size_t number, int width) {
  std::array<char, 20> reversed{};
  std::size_t count = 0;
  do {
    reversed[count++] = static_cast<char>('0' + number % 10U);
    number /= 10U;
  } while (number > 0 && count < reversed.size());
  for (auto pad = static_cast<std::size_t>(width); pad > count; --pad) text("0");
  while (count > 0) text({&reversed[--count], 1});
}

void NmeaWriter::decimal(double value, int before, int after) {
  if (value < 0.0) text("-");
  const std::size_t number = scaled(value, after);
  const auto one = static_cast<std::size_t>(std::llround(std::pow(10.0, after)));
  digits(number / one, before);
  text(".");
  digits(number % one, after);
}

void NmeaWriter::position(const rover::GnssFix& fix) {
  if (fix.mode < 2) return text(",,,,");
  const auto angle = [this](double degrees, int width) {
    // Counted in ten-millionths of a minute, so that 59.99999999 cannot round up to 60.
    const std::size_t all = scaled(degrees * 60.0, 7);
    constexpr std::size_t kDegree = 600'000'000;
    digits(all / kDegree, width);
    digits(all % kDegree / 10'000'000, 2);
    text(".");
    digits(all % 10'000'000, 7);
  };
  text(",");
  angle(fix.latitude, 2);
  text(fix.latitude < 0.0 ? ",S," : ",N,");
  angle(fix.longitude, 3);
  text(fix.longitude < 0.0 ? ",W" : ",E");
}

void NmeaWriter::time_of_day(double seconds) {
  const std::size_t hundredths = scaled(seconds, 2) % 8'640'000;
  digits(hundredths / 360'000, 2);
  digits(hundredths / 6'000 % 60, 2);
  digits(hundredths / 100 % 60, 2);
  text(".");
  digits(hundredths % 100, 2);
}

}  // namespace drivers
