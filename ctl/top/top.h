// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauvectl top without its terminal: the screen, and the effects of keys. Pure.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/screen.h"
#include "protocol/message.h"

namespace mauve::ctl {

using protocol::Json;

/// One component. Times in nanoseconds; none: there is none yet.
struct TopRow {
  std::string name;
  std::string state;  ///< of its state machine while it runs, else "stopped" and the like
  bool running = false;
  bool faulted = false;
  std::string core;  ///< with its version
  double priority = 0;
  std::string cpus;
  double every = 0;  ///< mean time from job to job
  std::optional<double> late_last;
  std::optional<double> late_max;
  bool unfinished = false;  ///< released, and its job has not ended
  std::optional<double> elapsed_last;
  std::optional<double> execution_p99;
  std::optional<double> execution_max;
  std::optional<double> busy;  ///< share of the time
  double missed = 0;
  double overruns = 0;
};

/// The answers of the daemon at one moment, to status.get and stats.get.
struct TopData {
  Json status;
  Json statistics;
};

/// One row a component. How busy each was since `before`; without that, since it is counted.
[[nodiscard]] std::vector<TopRow> top_rows(const TopData& now, const TopData& before);

/// For scripts.
[[nodiscard]] Json to_json(const TopRow& row);

enum class TopSort { priority, name, late, execution, busy, missed };
/// The key that chooses an order, and its name.
inline constexpr std::array<std::pair<char, const char*>, 6> kTopSorts{{{'P', "priority"},
                                                                        {'N', "name"},
                                                                        {'W', "wait"},
                                                                        {'E', "execution"},
                                                                        {'B', "busy"},
                                                                        {'M', "missed"}}};

/// The choices of the person at the terminal.
struct TopView {
  TopSort sort = TopSort::priority;
  std::string filter;
  bool typing = false;  ///< the filter
  bool paused = false;
  bool help = false;
  bool details = false;  ///< of the selected one
  bool quit = false;
  std::string selected;  ///< empty: the first
  std::string interval;  ///< as text
};

/// Those that the filter lets through, in order.
[[nodiscard]] std::vector<TopRow> arranged(std::vector<TopRow> rows, const TopView& view);
/// The row that is selected; none when there are no rows.
[[nodiscard]] std::optional<std::size_t> selected_row(const std::vector<TopRow>& rows,
                                                      const TopView& view);

struct Key {
  enum class Kind { character, up, down, enter, escape, erase };
  Kind kind = Kind::character;
  char character = 0;
};
/// Keys as a terminal sends them; other bytes are left out.
[[nodiscard]] std::vector<Key> keys_in(std::string_view bytes);
/// `rows` as arranged.
void press(TopView& view, const Key& key, const std::vector<TopRow>& rows);

struct Extent {
  std::size_t width = 80;
  std::size_t height = 24;
};

struct TopScene {
  std::string heading;
  std::vector<TopRow> rows;  ///< as arranged
  Json details;              ///< of the selected one, when they are shown; else null
  double now = 0;            ///< since T0
};

/// The lines of one picture, no more than the height, none wider than the width.
[[nodiscard]] std::vector<std::string> top_frame(const TopScene& scene, const TopView& view,
                                                 Extent extent, bool colour);
/// The table alone; width 0: as wide as it needs.
[[nodiscard]] std::string top_table(const std::vector<TopRow>& rows, std::size_t width, bool colour,
                                    std::optional<std::size_t> selected = std::nullopt);

}  // namespace mauve::ctl
