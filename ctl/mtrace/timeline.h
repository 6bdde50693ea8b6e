// SPDX-License-Identifier: LGPL-3.0-or-later
/// A trace as a picture, in the style of the paper's figures 4, 5 and 9.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

/// The part of the trace to draw; a part that the user does not give is chosen.
struct View {
  std::optional<std::int64_t> from;
  std::optional<std::int64_t> to;
  std::vector<std::string> components;  ///< empty: all, as far as they are not too many
};

struct Timeline {
  std::string svg;
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::vector<std::string> left_out;  ///< facts that it does not show; a sentence each
};

/// Tasks as rows by priority, arrows where they are released, boxes where they execute, changes as
/// lines through all of them. Of bounded size for any trace.
[[nodiscard]] Timeline draw_timeline(const Trace& trace, const View& view);

}  // namespace mauve::ctl::mtrace
