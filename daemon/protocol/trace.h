// SPDX-License-Identifier: LGPL-3.0-or-later
/// A trace as JSON, on the wire and in a file (.mtrace, a line each): a header, records by time, an
/// end. Times are ns since T0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/trace.h"
#include "protocol/message.h"

namespace mauve::protocol {

inline constexpr std::int64_t kTraceFormat = 1;
/// Of one page.
inline constexpr std::size_t kMostRecords = 5000;

struct TraceState {
  std::string name;
  bool waits = false;  ///< a synchronization state
  std::int64_t wait = 0;
};

struct TraceComponent {
  std::string name;
  std::string type;
  std::string core;
  std::optional<std::int64_t> change;  ///< that made it so; 0: as it was deployed
  std::string initial;
  std::int64_t priority = 0;
  std::vector<std::int64_t> cpus;
  bool realtime = false;
  std::optional<std::int64_t> scheduled;  ///< since then it has this priority and these CPUs
  std::optional<std::int64_t> timed;      ///< since then it has this core, period and budget
  std::int64_t period = 0;                ///< of its grid; zero: it has none
  std::int64_t offset = 0;
  std::int64_t deadline = 0;
  std::int64_t budget = 0;
  std::optional<std::int64_t> bound;  ///< of its response, as admitted
  bool measured = false;              ///< the bound rests on measured execution times
  std::vector<TraceState> states;

  [[nodiscard]] const TraceState* state(std::string_view called) const;
  /// Where it always runs, when that is one processor only.
  [[nodiscard]] std::optional<std::int64_t> cpu() const;
};

struct TraceHeader {
  std::string mauved;
  std::string architecture;
  std::string boot;
  std::string written;  ///< date and time
  std::int64_t t0 = 0;  ///< on the monotonic clock
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::string why;
  std::uint64_t lost = 0;  ///< records that were not collected in time
  bool probed = true;  ///< a probe measured all the time when the host, or foreign work, held it up
  std::vector<TraceComponent> components;
  std::vector<std::string> resources;
};

[[nodiscard]] Json to_json(const TraceHeader& header);
/// [time, thread, event, name, a, b]; empty items at the end are left out. The record's own numbers
/// of names are not looked at.
[[nodiscard]] Json trace_record(const TraceRecord& record, std::string_view thread,
                                std::string_view event, std::string_view name);
/// Without which a file was cut off.
[[nodiscard]] Json trace_end(std::size_t records, std::uint64_t lost);

}  // namespace mauve::protocol
