// SPDX-License-Identifier: LGPL-3.0-or-later
/// Recordings as JSON, the form of a page of the wire and of a file (.mtrace).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "protocol/framing.h"
#include "trace/memory.h"

namespace mauve::daemon {

/// Of one page.
inline constexpr std::size_t kMostBytes = 600'000;

/// The header of a recording that ends now.
[[nodiscard]] protocol::Json header_of(const Recording& recording, const std::string& boot);
[[nodiscard]] protocol::Json to_json(const TraceRecord& record);

[[nodiscard]] std::string to_text(const Recording& recording, const protocol::Json& header);

/// At most so many bytes of a file from a place on; empty: none, or it is no regular file.
[[nodiscard]] std::string part_of(const std::filesystem::path& file, std::size_t from,
                                  std::size_t most);
/// Of the first line of a file.
inline constexpr std::size_t kLongestHeader = 1 << 20;

/// A page of a recording in memory, from a record on: {"records", "next", "end"}.
[[nodiscard]] protocol::Json page_of(const Recording& recording, std::size_t from,
                                     std::size_t count);
/// The same of one in a file, with its header. `from` and "next" are places in the file, so that
/// the last page costs no more than the first; 0 is the first record. Waits for the disk.
[[nodiscard]] Result<protocol::Json> page_of(const std::filesystem::path& file, std::size_t from,
                                             std::size_t count);

}  // namespace mauve::daemon
