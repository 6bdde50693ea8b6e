// SPDX-License-Identifier: LGPL-3.0-or-later
/// From NMEA sentences to gnss_fix/1: one fix for each epoch, from GGA. Its dimensions are from the
/// last GSA, and RMC, GLL and GNS say whether it is valid and confirm it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "../../types/gnss.h"
#include "fix_gate.h"
#include "nmea_fields.h"

namespace drivers {

/// Time, place and status as RMC, GLL or GNS have them.
struct Witness {
  enum class Status : std::uint8_t { unknown, valid, invalid };

  double time = -1.0;  // s of the day; below 0: none
  Status status = Status::unknown;
  double latitude = 0.0;
  double longitude = 0.0;
  double grain = 0.0;  // deg, of its last digit; 0: no place
};

/// A GGA sentence as it was read.
struct Gga {
  rover::GnssFix fix;
  double time = -1.0;          // s of the day; below 0: none
  double rank = 0.0;           // more satellites, more rank
  double grain = 0.0;          // deg, of the last digit of the position
  double separation = 0.0;     // m, geoid above ellipsoid
  bool no_satellites = false;  // a position from 0 satellites
};

/// The epochs of a line on which several talkers may say each of them (GPGGA, GAGGA), or one says
/// it twice. The talker with the most satellites of one epoch is awaited in the next. All of it is
/// [rt].
class Talkers {
 public:
  using Talker = std::array<char, 2>;
  enum class Use : std::uint8_t {
    now,   ///< it is the awaited one, or none is awaited
    hold,  ///< the best of its epoch up to now; the awaited one may follow
    skip,  ///< worse, or its epoch is used already
  };

  /// A GGA of `time` (below 0: none) is of another epoch than the one before.
  [[nodiscard]] bool begins(const Talker& talker, double time) const;
  /// A GGA of another talker than the first one, of an epoch before this one.
  [[nodiscard]] bool comes_late(const Talker& talker, double time) const;
  /// Takes a GGA.
  Use take(const Talker& talker, double time, double rank);
  /// The epoch is used without the awaited talker.
  void settle() { used_ = true; }
  /// Of the last GGA; zeros: there was none.
  [[nodiscard]] const Talker& last() const { return last_; }

 private:
  double time_ = -1.0;
  double best_rank_ = 0.0;
  Talker first_{};    // of this epoch
  Talker best_{};     // of this epoch
  Talker last_{};     // of the last GGA
  Talker awaited_{};  // best of the epoch before, if it was not the first of it
  bool used_ = false;
};

/// Keeps the values of one sentence that matter for the next. An epoch is held back while it may
/// still get better: by a GGA of another talker, or by its status. All of it is [rt].
class FixReader {
 public:
  enum class Event : std::uint8_t {
    ignored,    ///< a sentence without anything we use, or an epoch that is held
    fix,        ///< an epoch: see fix()
    malformed,  ///< right checksum, but fields that cannot be
  };

  /// `frame` is the text between `$` and `*`.
  Event read(std::string_view frame);
  /// The last read() gave the epoch before, which was held: its frame is to be read once more.
  [[nodiscard]] bool unread() const { return unread_; }
  /// An epoch is held back.
  [[nodiscard]] bool holds() const { return held_.has_value() || waits_; }
  /// Gives the epoch that is held as it is.
  Event release();
  /// The fix of the last epoch, and further knowledge of it.
  [[nodiscard]] const rover::GnssFix& fix() const { return fix_; }
  [[nodiscard]] const FixContext& context() const { return context_; }

 private:
  using Status = Witness::Status;

  [[nodiscard]] bool counts_gns(std::string_view address, std::string_view modes) const;
  Event read_gga(const Fields& fields);
  Event begin(const Gga& gga);
  Event read_gsa(const Fields& fields);
  Event hear(const Witness& said, Witness& kept);
  Event decide(Status status);
  [[nodiscard]] std::array<const Witness*, 3> witnesses() const { return {&rmc_, &gll_, &gns_}; }
  [[nodiscard]] Status status_now() const;
  [[nodiscard]] Status status_before() const;
  [[nodiscard]] Status status_known() const;
  void compare(bool same);

  rover::GnssFix fix_;
  FixContext context_;
  Witness rmc_;
  Witness gll_;
  Witness gns_;
  Talkers talkers_;
  std::optional<Gga> held_;     // for the awaited talker
  double time_ = -1.0;          // of the last GGA
  double grain_ = 0.0;          // deg, of the last digit of the position in GGA
  double dilution_ = 0.0;       // of the last GSA
  int dimensions_ = 0;          // best GSA since the last GGA: 0 none heard, 1 no fix, 2, 3
  int agreed_ = 0;              // how well the sentences of this receiver agree
  bool no_satellites_ = false;  // GGA has a position from 0 satellites
  bool waits_ = false;          // for the status of its epoch
  bool answered_ = false;       // the status of this epoch came after its GGA
  bool answers_after_ = false;  // as that of the one before did
  bool unread_ = false;
};

}  // namespace drivers
