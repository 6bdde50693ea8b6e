// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces for other tools.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mauve/result.h"
#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

enum class Format : std::uint8_t {
  mtrace,  ///< mauve's own
  chrome,  ///< for ui.perfetto.dev and Chrome
  ctf,     ///< a folder, for babeltrace2 and Trace Compass
};
[[nodiscard]] std::optional<Format> format_named(std::string_view name);
/// By the end of its name: ".mtrace", ".json", else a folder of CTF.
[[nodiscard]] Format format_of(std::string_view path);

/// The first characters of each such file, in a folder of its metadata.
[[nodiscard]] std::string_view begin_of(Format format);

/// Writes the file, or the folder. Refused with the words of the system when that is not possible.
Status convert(const Trace& trace, Format format, const std::string& path);

}  // namespace mauve::ctl::mtrace
