// SPDX-License-Identifier: LGPL-3.0-or-later
/// Where answers go: data to one stream, messages to the other, colours only for people.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>

namespace mauve::ctl {

enum class Colour { automatic, always, never };

struct Screen {
  std::ostream& out;  ///< data only
  std::ostream& err;  ///< messages
  bool json = false;  ///< one line of JSON on `out` for every answer, errors included
  bool colour_out = false;
  bool colour_err = false;
  std::size_t width = 0;      ///< columns of a terminal that `out` has to fit into; 0: no limit
  std::size_t width_err = 0;  ///< the same for `err`
};

/// Standard output and error of this process; looks at isatty, NO_COLOR, TERM and the width.
[[nodiscard]] Screen standard_screen(bool json, Colour colour);

enum class Paint { plain, bold, red, green, yellow };

/// The text with the escapes around it, or as it is.
[[nodiscard]] std::string painted(std::string_view text, Paint paint, bool colour);

}  // namespace mauve::ctl
