// SPDX-License-Identifier: LGPL-3.0-or-later
/// The Common Trace Format 1.8 (diamon.org/ctf), which babeltrace2 and Trace Compass read.
#pragma once

#include <string>

#include "mauve/result.h"
#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

/// The description of the stream, in TSDL. All its numbers are little endian and begin at bytes.
[[nodiscard]] std::string ctf_metadata(const Trace& trace);
/// One packet with all events, by time.
[[nodiscard]] std::string ctf_stream(const Trace& trace);

/// Makes the folder, with a file "metadata" and a file "stream".
Status write_ctf(const Trace& trace, const std::string& folder);

}  // namespace mauve::ctl::mtrace
