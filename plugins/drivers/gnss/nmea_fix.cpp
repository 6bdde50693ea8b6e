// SPDX-License-Identifier: LGPL-3.0-or-later
#include "nmea_fix.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>

namespace drivers {
namespace {

using rover::GnssFix;

constexpr int kTrusted = 2;  // that many times RMC or GLL agreed with GGA

/// The comma-separated fields of a sentence; field 0 is the address. Beyond the capacity they are
/// cut.
struct Fields {
  std::array<std::string_view, 32> text{};
  std::size_t size = 0;

  explicit Fields(std::string_view frame) {
    while (size < text.size()) {
      const std::size_t comma = frame.find(',');
      text[size++] = frame.substr(0, comma);
      if (comma == std::string_view::npos) break;
      frame.remove_prefix(comma + 1);
    }
  }
  std::string_view operator[](std::size_t i) const {
    return i < size ? text[i] : std::string_view();
  }
};

/// Plain decimal: digits, at most one dot, perhaps a minus. No exponent, no "inf".
std::optional<double> number(std::string_view text) {
  const auto plain = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; };
  if (!std::all_of(text.begin(), text.end(), plain)) return {};
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

/// An optional number: empty is `otherwise`, nonsense is nothing.
std::optional<double> number_or(std::string_view text, double otherwise) {
  return text.empty() ? otherwise : number(text);
}

/// "dddmm.mmmm" with its hemisphere: degrees, or nothing when it cannot be.
std::optional<double> angle(std::string_view text, std::string_view side, std::string_view sides,
                            double largest) {
  const std::optional<double> packed = number(text);
  if (!packed || side.size() != 1 || sides.find(side) == std::string_view::npos) return {};
  const double degrees = std::floor(*packed / 100.0);
  const double minutes = *packed - 100.0 * degrees;
  const double angle = degrees + minutes / 60.0;
  if (*packed < 0.0 || minutes >= 60.0 || angle > largest) return {};
  return side[0] == sides[0] ? angle : -angle;
}

/// "hhmmss.ss": seconds of the day.
std::optional<double> time_of_day(std::string_view text) {
  const std::optional<double> packed = number_or(text, 0.0);
  if (!packed || *packed < 0.0 || *packed >= 240000.0) return {};
  const double hours = std::floor(*packed / 10000.0);
  const double minutes = std::floor(std::fmod(*packed, 10000.0) / 100.0);
  const double seconds = std::fmod(*packed, 100.0);
  if (minutes >= 60.0 || seconds >= 61.0) return {};
  return hours * 3600.0 + minutes * 60.0 + seconds;
}

/// Degrees that the last digit of "dddmm.mmmm" stands for.
double grain_of(std::string_view text) {
  const std::size_t dot = text.find('.');
  const std::size_t decimals = dot == std::string_view::npos ? 0 : text.size() - dot - 1;
  return std::pow(10.0, -static_cast<double>(decimals)) / 60.0;
}

/// Time and place from these fields of RMC or GLL; of no grain when they have none.
Witness read_witness(const Fields& fields, std::size_t time, std::size_t place) {
  const auto when = time_of_day(fields[time]);
  const auto latitude = angle(fields[place], fields[place + 1], "NS", 90.0);
  const auto longitude = angle(fields[place + 2], fields[place + 3], "EW", 180.0);
  if (fields[time].empty() || !when || !latitude || !longitude) return {};
  return {*when, *latitude, *longitude,
          std::max(grain_of(fields[place]), grain_of(fields[place + 2]))};
}

/// To the digits that both carry: one may have cut the digits that the other rounded.
bool same_place(const Witness& said, const GnssFix& fix, double grain) {
  const double most = 1.01 * std::max(said.grain, grain);
  return std::abs(said.latitude - fix.latitude) <= most &&
         std::abs(std::remainder(said.longitude - fix.longitude, 360.0)) <= most;
}

bool same_epoch(const Witness& said, const GnssFix& fix) {
  return said.grain > 0.0 && fix.mode > 1 && std::abs(said.time - fix.time) < 1e-3;
}

/// A measured position from 0 satellites is no fix, of any quality: while a receiver searches, it
/// repeats an old position. Estimated, manual and simulated positions (quality 6 to 8) need no
/// satellite. An empty field does not state the number.
bool without_satellites(const Fields& fields, double quality, double satellites) {
  return !fields[7].empty() && satellites == 0.0 && (quality < 6.0 || quality > 8.0);
}

/// GGA: 1 time, 2-5 position, 6 quality, 7 satellites, 8 dilution, 9 altitude. Nothing: malformed.
std::optional<GnssFix> parse_gga(const Fields& fields, int dimensions) {
  const auto time = time_of_day(fields[1]);
  const auto quality = number_or(fields[6], 0.0);
  const auto satellites = number_or(fields[7], 0.0);
  const auto hdop = number_or(fields[8], 0.0);
  const auto altitude = number_or(fields[9], 0.0);
  if (fields.size < 10 || !time || !quality || !satellites || !hdop || !altitude) return {};
  if (*satellites < 0.0 || *satellites > 1000.0 || *hdop < 0.0) return {};
  // A comma more or less shifts the rest.
  if (!fields[10].empty() && fields[10] != "M") return {};
  GnssFix fix;
  fix.time = *time;
  fix.satellites = static_cast<std::int32_t>(*satellites);
  fix.hdop = *hdop;
  if (*quality == 0.0 || (fields[2].empty() && fields[4].empty())) return fix;
  if (without_satellites(fields, *quality, *satellites)) return fix;
  const auto latitude = angle(fields[2], fields[3], "NS", 90.0);
  const auto longitude = angle(fields[4], fields[5], "EW", 180.0);
  if (!latitude || !longitude) return {};
  fix.latitude = *latitude;
  fix.longitude = *longitude;
  fix.altitude = *altitude;
  // GSA comes after GGA in most receivers, so ours is of the epoch before: only its "2D" is worth
  // more than an altitude in this very sentence.
  fix.mode = fields[9].empty() || dimensions == 2 ? 2 : 3;
  return fix;
}

}  // namespace

FixReader::Event FixReader::read(std::string_view frame) {
  const Fields fields(frame);
  const std::string_view address = fields[0];
  if (address.size() != 5 || address[0] == 'P') return Event::ignored;
  const std::string_view sentence = address.substr(2);
  if (sentence == "GSA") {
    const std::string_view mode = fields[2];
    if (mode.size() != 1 || mode[0] < '1' || mode[0] > '3') return Event::malformed;
    dimensions_ = std::max(dimensions_, mode[0] - '0');
    dilution_ = number_or(fields[16], 0.0).value_or(0.0);
    return Event::ignored;
  }
  if (sentence == "RMC") hear(read_witness(fields, 1, 3), rmc_);
  if (sentence == "GLL") hear(read_witness(fields, 5, 1), gll_);
  return sentence == "GGA" ? read_gga(frame) : Event::ignored;
}

FixReader::Event FixReader::read_gga(std::string_view frame) {
  const Fields fields(frame);
  const std::optional<GnssFix> fix = parse_gga(fields, dimensions_);
  dimensions_ = 0;
  if (!fix) return Event::malformed;
  fix_ = *fix;
  grain_ = std::max(grain_of(fields[2]), grain_of(fields[4]));
  context_ = {};
  context_.separation = number_or(fields[11], 0.0).value_or(0.0);
  context_.dilution_known = dilution_ > 0.0 && dilution_ == fix_.hdop;
  for (const Witness* said : {&rmc_, &gll_}) {
    if (!same_epoch(*said, fix_)) continue;
    const bool same = same_place(*said, fix_, grain_);
    context_.confirmed = context_.confirmed || same;
    context_.denied = context_.denied || (!same && agreed_ >= kTrusted);
    compare(same);
  }
  // Two against one.
  context_.denied = context_.denied && !context_.confirmed;
  return Event::fix;
}

void FixReader::hear(const Witness& said, Witness& kept) {
  kept = said;
  if (same_epoch(said, fix_)) compare(same_place(said, fix_, grain_));
}

/// A receiver whose sentences differ by habit is not believed when they do.
void FixReader::compare(bool same) {
  agreed_ = same ? std::min(agreed_ + 1, 2 * kTrusted) : std::max(agreed_ - kTrusted, 0);
}

}  // namespace drivers
