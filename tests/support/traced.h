// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces as text, for tests that compare them.
#pragma once

#include <bit>
#include <string>
#include <vector>

#include <mauve/host/deployer.h>
#include <mauve/trace.h>

namespace mauve::test {

/// "10000000 control release  10000000 0"
inline std::string to_text(const TraceRecord& record) {
  std::string text = std::to_string(record.time) + " ";
  text.append(trace_name(record.thread)).append(" ").append(to_string(record.kind));
  text.append(" ").append(trace_name(record.name));
  text += " " + std::to_string(record.a) + " ";
  const bool number = record.kind == TraceKind::user;
  return text +
         (number ? std::to_string(std::bit_cast<double>(record.b)) : std::to_string(record.b));
}

inline std::vector<TraceRecord> drain_trace(Deployer& deployer) {
  std::vector<TraceRecord> all;
  deployer.drain_trace([&](const TraceRecord& record) { all.push_back(record); });
  return all;
}

/// Of one thread; all of them when it is not named.
inline std::vector<std::string> trace_of(Deployer& deployer, const std::string& thread = "") {
  std::vector<std::string> texts;
  for (const TraceRecord& record : drain_trace(deployer)) {
    if (thread.empty() || trace_name(record.thread) == thread) texts.push_back(to_text(record));
  }
  return texts;
}

inline std::vector<TraceRecord> of_kind(const std::vector<TraceRecord>& all, TraceKind kind) {
  std::vector<TraceRecord> found;
  for (const TraceRecord& record : all) {
    if (record.kind == kind) found.push_back(record);
  }
  return found;
}

}  // namespace mauve::test
