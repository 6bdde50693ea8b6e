// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rows that `mauvectl record` wrote of one address, read back as values of one type.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/host/value.h>
#include <mauve/result.h>
#include <mauve/type.h>

namespace drivers {

/// One recorded value.
struct CsvRow {
  std::int64_t time = 0;  ///< ns since T0 of the run that was recorded
  std::size_t line = 0;   ///< of the file
  mauve::Value value;
};

/// The rows of one address, and the time of the whole file, which all its addresses share.
struct CsvRecording {
  std::vector<CsvRow> rows;  ///< one at least
  std::int64_t first = 0;    ///< ns, of the earliest row of any address
  std::int64_t last = 0;     ///< of the latest one
};

/// Reads CSV as RFC 4180 has it: column 1 is `time_s`, the others are an address and the field of
/// its value, such as `pose.read.x`. Of rows of other addresses and of rows that mark a gap only
/// the time counts. `address` may be empty when all columns are of one. Numbers come back exactly
/// as they were. `name` stands for the file in errors, which name the line. [factory]
[[nodiscard]] mauve::Result<CsvRecording> read_csv(std::string_view text,
                                                   const mauve::DataType& type,
                                                   const std::string& address,
                                                   const std::string& name);

}  // namespace drivers
