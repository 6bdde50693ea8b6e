// SPDX-License-Identifier: LGPL-3.0-or-later
#include "nmea_fix.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace drivers {
namespace {

using rover::GnssFix;

constexpr int kTrusted = 2;      // that many times RMC or GLL agreed with GGA
constexpr double kStale = 10.0;  // s that the status of another epoch counts
constexpr double kLate = 2.0;    // s that a talker may be behind the first one
constexpr double kSecondsOfADay = 86'400.0;

using Validity = Witness::Status;

constexpr std::string_view kUnmeasured = "NEMS";  // none, dead reckoning, by hand, simulated

/// Of GNS, which has a mode for each system.
Validity status_of_modes(std::string_view modes) {
  if (modes.empty()) return Validity::unknown;
  const bool none = modes.find_first_not_of(kUnmeasured) == std::string_view::npos;
  return none ? Validity::invalid : Validity::valid;
}

/// "V" is void.
Validity status_of(std::string_view status, std::string_view mode) {
  if (status == "V") return Validity::invalid;
  if (mode.size() == 1 && kUnmeasured.find(mode) != std::string_view::npos) {
    return Validity::invalid;
  }
  return status == "A" ? Validity::valid : Validity::unknown;
}

/// From RMC, GLL or GNS, with these places of its time and position.
Witness read_witness(const Fields& fields, std::size_t time, std::size_t place, Validity status) {
  Witness said;
  said.status = status;
  const auto when = time_of_day(fields[time]);
  if (!fields[time].empty() && when) said.time = *when;
  const auto latitude = angle(fields[place], fields[place + 1], "NS", 90.0);
  const auto longitude = angle(fields[place + 2], fields[place + 3], "EW", 180.0);
  if (said.time < 0.0 || !latitude || !longitude) return said;
  said.latitude = *latitude;
  said.longitude = *longitude;
  said.grain = std::max(grain_of(fields[place]), grain_of(fields[place + 2]));
  return said;
}

/// To the digits that both carry: one may have cut the digits that the other rounded.
bool same_place(const Witness& said, const GnssFix& fix, double grain) {
  const double most = 1.01 * std::max(said.grain, grain);
  return std::abs(said.latitude - fix.latitude) <= most &&
         std::abs(std::remainder(said.longitude - fix.longitude, 360.0)) <= most;
}

bool at(const Witness& said, double time) {
  return said.time >= 0.0 && time >= 0.0 && std::abs(said.time - time) < 1e-3;
}

bool same_epoch(const Witness& said, const GnssFix& fix) {
  return said.grain > 0.0 && fix.mode > 1 && at(said, fix.time);
}

/// 0 is no fix; 6 is dead reckoning, 7 typed in by hand, 8 simulated.
bool measured(double quality) { return quality != 0.0 && (quality < 6.0 || quality > 8.0); }

/// GGA: 1 time, 2-5 position, 6 quality, 7 satellites, 8 dilution, 9 altitude, 11 separation.
/// Nothing: malformed.
std::optional<Gga> parse_gga(const Fields& fields, int dimensions) {
  const auto time = time_of_day(fields[1]);
  const auto quality = number_or(fields[6], 0.0);
  const auto satellites = number_or(fields[7], 0.0);
  const auto hdop = number_or(fields[8], 0.0);
  const auto altitude = number_or(fields[9], 0.0);
  if (fields.size() < 10 || !time || !quality || !satellites || !hdop || !altitude) return {};
  if (*satellites < 0.0 || *satellites > 1000.0 || *hdop < 0.0) return {};
  // A comma more or less shifts the rest.
  if (!fields[10].empty() && fields[10] != "M") return {};
  Gga gga;
  GnssFix& fix = gga.fix;
  fix.time = *time;
  fix.satellites = static_cast<std::int32_t>(*satellites);
  fix.hdop = *hdop;
  if (!fields[1].empty()) gga.time = *time;
  gga.grain = std::max(grain_of(fields[2]), grain_of(fields[4]));
  gga.separation = number_or(fields[11], 0.0).value_or(0.0);
  if (!measured(*quality) || (fields[2].empty() && fields[4].empty())) return gga;
  const auto latitude = angle(fields[2], fields[3], "NS", 90.0);
  const auto longitude = angle(fields[4], fields[5], "EW", 180.0);
  if (!latitude || !longitude) return {};
  fix.latitude = *latitude;
  fix.longitude = *longitude;
  fix.altitude = *altitude;
  // GSA comes after GGA in most receivers, so ours is of the epoch before: only its "2D" is worth
  // more than an altitude in this very sentence.
  fix.mode = fields[9].empty() || dimensions == 2 ? 2 : 3;
  gga.rank = 1.0 + fix.satellites;
  gga.no_satellites = fix.satellites == 0 && !fields[7].empty();
  return gga;
}

}  // namespace

bool Talkers::begins(const Talker& talker, double time) const {
  return time >= 0.0 ? time != time_ : talker == first_ || talker == last_;
}

bool Talkers::comes_late(const Talker& talker, double time) const {
  const bool placed = best_rank_ > 0.0;  // else the late one may be the only one with a fix
  if (!placed || time < 0.0 || time_ < 0.0 || talker == first_) return false;
  const double behind = std::remainder(time_ - time, kSecondsOfADay);
  return behind > 0.0 && behind <= kLate;
}

Talkers::Use Talkers::take(const Talker& talker, double time, double rank) {
  if (begins(talker, time)) {
    awaited_ = best_ == first_ ? Talker{} : best_;
    first_ = best_ = talker;
    best_rank_ = rank;
    time_ = time;
    used_ = false;
  } else if (rank > best_rank_) {
    best_ = talker;
    best_rank_ = rank;
  }
  last_ = talker;
  if (used_) return Use::skip;
  if (awaited_ != Talker{} && awaited_ != talker) return talker == best_ ? Use::hold : Use::skip;
  used_ = true;
  return Use::now;
}

FixReader::Event FixReader::read(std::string_view frame) {
  unread_ = false;
  const Fields fields(frame);
  const std::string_view address = fields[0];
  if (address.size() != 5 || address[0] == 'P') return Event::ignored;
  const std::string_view sentence = address.substr(2);
  if (sentence == "GGA") return read_gga(fields);
  if (sentence == "GSA") return read_gsa(fields);
  if (sentence == "RMC") {
    return hear(read_witness(fields, 1, 3, status_of(fields[2], fields[12])), rmc_);
  }
  if (sentence == "GLL") {
    return hear(read_witness(fields, 5, 1, status_of(fields[6], fields[7])), gll_);
  }
  if (sentence == "GNS" && counts_gns(address, fields[6]))
    return hear(read_witness(fields, 1, 2, status_of_modes(fields[6])), gns_);
  return Event::ignored;
}

/// One of a single system says nothing of a fix by several.
bool FixReader::counts_gns(std::string_view address, std::string_view modes) const {
  const Talkers::Talker talker{address[0], address[1]};
  const bool ours = talker == talkers_.last() || talkers_.last() == Talkers::Talker{};
  return !modes.empty() && (address.starts_with("GN") || ours);
}

FixReader::Event FixReader::read_gsa(const Fields& fields) {
  const std::string_view mode = fields[2];
  if (mode.empty()) return Event::ignored;
  if (mode.size() != 1 || mode[0] < '1' || mode[0] > '3') return Event::malformed;
  dimensions_ = std::max(dimensions_, mode[0] - '0');
  dilution_ = number_or(fields[16], 0.0).value_or(0.0);
  return Event::ignored;
}

FixReader::Event FixReader::read_gga(const Fields& fields) {
  const std::optional<Gga> gga = parse_gga(fields, dimensions_);
  if (!gga) return Event::malformed;
  const Talkers::Talker talker{fields[0][0], fields[0][1]};
  if (talkers_.comes_late(talker, gga->time)) return Event::ignored;
  unread_ = holds() && talkers_.begins(talker, gga->time);
  if (unread_) return release();
  const Talkers::Use use = talkers_.take(talker, gga->time, gga->rank);
  if (use == Talkers::Use::hold) held_ = gga;
  if (use != Talkers::Use::now) return Event::ignored;
  const std::optional<Gga> held = std::exchange(held_, std::nullopt);
  return begin(held && held->rank > gga->rank ? *held : *gga);
}

FixReader::Event FixReader::release() {
  if (held_) {
    const Gga held = *held_;
    held_.reset();
    talkers_.settle();
    if (const Event event = begin(held); event == Event::fix) return event;
  }
  return waits_ ? decide(status_known()) : Event::ignored;
}

FixReader::Event FixReader::begin(const Gga& gga) {
  answers_after_ = std::exchange(answered_, false);
  time_ = gga.time;
  fix_ = gga.fix;
  no_satellites_ = gga.no_satellites;
  grain_ = gga.grain;
  context_ = {};
  context_.separation = gga.separation;
  context_.dilution_known = dilution_ > 0.0 && dilution_ == fix_.hdop;
  const bool doubt = fix_.mode > 1 && (no_satellites_ || status_before() == Status::invalid);
  waits_ = doubt && status_now() == Status::unknown && answers_after_;
  return waits_ ? Event::ignored : decide(status_known());
}

/// The fix is complete: what RMC, GLL and GNS say decides whether it is one.
FixReader::Event FixReader::decide(Status status) {
  waits_ = false;
  // A receiver that searches repeats an old position, with 0 satellites in GGA.
  const bool old = no_satellites_ && (status != Status::valid || dimensions_ == 1);
  dimensions_ = 0;
  if (status == Status::invalid || old) {
    fix_.mode = 1;
    fix_.latitude = fix_.longitude = fix_.altitude = 0.0;
  }
  for (const Witness* said : witnesses()) {
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

FixReader::Event FixReader::hear(const Witness& said, Witness& kept) {
  kept = said;
  const bool of_epoch = at(said, time_);
  if (said.status != Status::unknown) answered_ = answered_ || of_epoch || time_ < 0.0;
  if (waits_ && of_epoch && said.status != Status::unknown) return decide(status_now());
  if (!waits_ && same_epoch(said, fix_)) compare(same_place(said, fix_, grain_));
  return Event::ignored;
}

/// Of the epoch of the last GGA.
Witness::Status FixReader::status_now() const {
  Status status = Status::unknown;
  for (const Witness* said : witnesses()) {
    if (!at(*said, time_) || said->status == Status::unknown) continue;
    if (said->status == Status::invalid) return Status::invalid;
    status = Status::valid;
  }
  return status;
}

/// Of an epoch shortly before.
Witness::Status FixReader::status_before() const {
  for (const Witness* said : witnesses()) {
    if (said->status != Status::invalid || said->time < 0.0 || time_ < 0.0) continue;
    if (std::abs(std::remainder(time_ - said->time, kSecondsOfADay)) <= kStale)
      return Status::invalid;
  }
  return Status::unknown;
}

/// Of this epoch, or else of one shortly before that was void.
Witness::Status FixReader::status_known() const {
  const Status now = status_now();
  return now == Status::unknown && status_before() == Status::invalid ? Status::invalid : now;
}

/// A receiver whose sentences differ by habit is not believed when they do.
void FixReader::compare(bool same) {
  agreed_ = same ? std::min(agreed_ + 1, 2 * kTrusted) : std::max(agreed_ - kTrusted, 0);
}

}  // namespace drivers
