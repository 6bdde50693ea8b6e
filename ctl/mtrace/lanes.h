// SPDX-License-Identifier: LGPL-3.0-or-later
/// Records put together again: jobs, states and locks of each thread, as pictures need them.
#pragma once

#include <vector>

#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

/// Something that lasted: an execution state, a wait for a lock, a lock that was held.
struct Span {
  std::int64_t from = 0;
  std::int64_t to = 0;
  Word name = 0;
  bool flagged = false;  ///< a state that was preempted; a wait that timed out
};

struct Job {
  std::int64_t release = 0;  ///< logical
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::int64_t next = 0;    ///< the release that its end announced; of a whole job
  std::int64_t change = 0;  ///< the last one that was applied
  std::int64_t late = 0;    ///< after its deadline; zero: it was in time
  std::int64_t missed = 0;  ///< releases from `next` on, for which no job ran
  bool whole = false;       ///< it ended in a wait
  bool failed = false;
  bool preempted = false;
};

struct Lane {
  Word thread = 0;
  const Component* component = nullptr;  ///< null: [control], [probe], or not in the header
  std::vector<Job> jobs;
  std::vector<Span> states;
  std::vector<Span> waits;  ///< for locks
  std::vector<Span> holds;
  std::vector<const Record*> marks;  ///< everything that lasted no time
};

/// One for each component of the header, the most urgent first, then the other threads that have
/// records. They point into the trace.
[[nodiscard]] std::vector<Lane> lanes_of(const Trace& trace);

}  // namespace mauve::ctl::mtrace
