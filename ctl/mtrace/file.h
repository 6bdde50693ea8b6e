// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces as text: a header, a record a line, an end. The reader keeps every sound part of a file.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>

#include "mauve/result.h"
#include "mtrace/trace.h"
#include "protocol/framing.h"

namespace mauve::ctl::mtrace {

using protocol::Json;

/// A longer line is no line of a trace, and is not kept.
inline constexpr std::size_t kLongestLine = 1024 * 1024;

/// Makes a Trace of a header and records as the wire or a file has them.
class Builder {
 public:
  /// Refused: another version, or no header at all.
  Status header(const Json& header);
  /// Records that are none, or of an unknown event, are left out and counted.
  void record(const Json& record, std::uint64_t line = 0);
  void broken(std::uint64_t line, std::string reason);
  void complete() { trace_.reading.complete = true; }
  [[nodiscard]] Trace take() { return std::move(trace_); }

 private:
  Trace trace_;
};

/// Takes a file in pieces of any size; memory grows with its sound lines only.
class Reader {
 public:
  void feed(std::string_view bytes);
  /// After the last piece. Refused: a file that does not begin as a trace of this version.
  [[nodiscard]] Result<Trace> finish();

 private:
  void line();

  Builder builder_;
  Status refused_;
  std::string partial_;
  std::uint64_t number_ = 1;  // of the line that begins, or goes on, in partial_
  bool too_long_ = false;
  bool ended_ = false;  // its last line was there
};

/// The file, or why it cannot be read; `at` of an error is its name.
[[nodiscard]] Result<Trace> read_file(const std::string& path);

/// With the end of its line.
[[nodiscard]] std::string record_line(const Trace& trace, const Record& record);
/// A complete file.
void write(const Trace& trace, std::ostream& out);

}  // namespace mauve::ctl::mtrace
