// SPDX-License-Identifier: LGPL-3.0-or-later
/// One picture of top as lines.
#include <algorithm>
#include <array>
#include <cstdio>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"
#include "top/top.h"

namespace mauve::ctl {
namespace {

constexpr std::string_view kHints = "q quit  s sort  f filter  p pause  d details  ? help";
constexpr std::array<std::string_view, 16> kHelp{
    "q         quit",
    "s         next order; P priority, N name, W wait, E execution, B busy, M missed",
    "f         show only what has this in its name or core; Esc: all again",
    "p         pause: the picture stays, the system goes on",
    "up, down  choose a component",
    "d, Enter  its details, with its states; again: back",
    "",
    "EVERY     mean time from one of its jobs to the next",
    "WAIT WMAX from release to start of a job: the last, the longest",
    "EXEC      execution of the last job; +++: released, and not finished",
    "P99 EMAX  99 of a hundred jobs took no longer, and the longest one: of those that nothing",
    "          came between",
    "BUSY      share of the time in jobs, with what came between",
    "MISS OVER releases that never ran; jobs that ended too late",
    "          all since another core came in, or mauvectl stats reset",
    "any key   back"};

std::string format(const char* text, double value, const char* unit) {
  std::array<char, 32> out{};
  std::snprintf(out.data(), out.size(), text, value, unit);
  return out.data();
}

/// At most five columns: "950ns", "1.2us", "38us".
std::string short_time(double nanoseconds) {
  constexpr std::array<const char*, 4> kUnits{"ns", "us", "ms", "s"};
  std::size_t unit = 0;
  double value = nanoseconds;
  while (value >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1000;
    ++unit;
  }
  return format(value < 9.95 && unit > 0 ? "%.1f%s" : "%.0f%s", value, kUnits.at(unit));
}

std::string short_time(const std::optional<double>& nanoseconds) {
  return nanoseconds ? short_time(*nanoseconds) : "-";
}

std::string share(const std::optional<double>& part) {
  if (!part) return "-";
  return format(*part < 0.0995 ? "%.1f%s" : "%.0f%s", 100 * *part, "%");
}

std::string whole(double count) { return format("%.0f%s", count, ""); }

Cell trouble_count(double count) {
  return {whole(count), count > 0 ? Paint::yellow : Paint::plain};
}

Paint paint_of(const TopRow& row) {
  if (row.faulted) return Paint::red;
  return row.running ? Paint::plain : Paint::yellow;
}

std::vector<Cell> cells_of(const TopRow& row) {
  const std::string where = row.cpus.empty() ? "" : "/" + row.cpus;
  return {{row.name},
          {row.state, paint_of(row)},
          {whole(row.priority) + where},
          {row.every > 0 ? short_time(row.every) : "-"},
          {short_time(row.late_last)},
          {short_time(row.late_max)},
          {row.unfinished ? "+++" : short_time(row.elapsed_last)},
          {short_time(row.execution_p99)},
          {short_time(row.execution_max)},
          {share(row.busy)},
          trouble_count(row.missed),
          trouble_count(row.overruns),
          {row.core}};
}

std::vector<std::string> kept_lines(const std::string& text) {
  const auto lines = lines_of(text);
  return {lines.begin(), lines.end()};
}

std::string second_line(const TopView& view) {
  std::string text = "by ";
  text += kTopSorts.at(static_cast<std::size_t>(view.sort)).second;
  if (!view.interval.empty()) text += ", every " + view.interval;
  if (!view.filter.empty() && !view.typing) text += ", with \"" + harmless(view.filter) + "\"";
  if (view.paused) text += ", PAUSED";
  return text;
}

/// The titles, then so many rows that the selected one is among them.
std::vector<std::string> window_of(const TopScene& scene, const TopView& view, std::size_t width,
                                   std::size_t room, bool colour) {
  const auto selected = selected_row(scene.rows, view);
  auto lines = kept_lines(top_table(scene.rows, width, colour, selected));
  if (!selected) lines.emplace_back("no component");
  if (lines.size() <= room || room < 2) return lines;
  const std::size_t shown = room - 1;
  const std::size_t first = *selected < shown ? 0 : *selected + 1 - shown;
  const auto rows = lines.begin() + 1;
  lines.erase(rows + static_cast<std::ptrdiff_t>(first + shown), lines.end());
  lines.erase(rows, rows + static_cast<std::ptrdiff_t>(first));
  return lines;
}

std::vector<std::string> body_of(const TopScene& scene, const TopView& view, Extent extent,
                                 bool colour) {
  if (view.help) return {kHelp.begin(), kHelp.end()};
  if (view.details && scene.details.is_object()) {
    return kept_lines(render_details(scene.details, scene.now, {extent.width, colour}));
  }
  const std::size_t room = extent.height > 3 ? extent.height - 3 : 0;
  return window_of(scene, view, extent.width, room, colour);
}

}  // namespace

std::string top_table(const std::vector<TopRow>& rows, std::size_t width, bool colour,
                      std::optional<std::size_t> selected) {
  Table table({{"NAME"},
               {"STATE"},
               {"PR/CPU", true, 7},
               {"EVERY", true, 10},
               {"WAIT", true, 8},
               {"WMAX", true, 4},
               {"EXEC", true, 3},
               {"P99", true, 9},
               {"EMAX", true, 5},
               {"BUSY", true, 2},
               {"MISS", true, 1},
               {"OVER", true, 6},
               {"CORE", false, 7}},
              {1, 6, true});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<Cell> cells = cells_of(rows[i]);
    if (selected) cells[0].text.insert(0, i == *selected ? ">" : " ");
    if (i == selected) cells[0].paint = Paint::bold;
    table.add(std::move(cells));
  }
  return table.text(width, colour);
}

std::vector<std::string> top_frame(const TopScene& scene, const TopView& view, Extent extent,
                                   bool colour) {
  // So narrow that lines are cut, which must not happen within an escape.
  const bool painted_lines = colour && extent.width >= 40;
  std::vector<std::string> lines{cut(harmless(scene.heading), extent.width),
                                 cut(second_line(view), extent.width)};
  for (std::string& line : body_of(scene, view, extent, painted_lines)) {
    lines.push_back(painted_lines && !view.help ? std::move(line) : cut(line, extent.width));
  }
  lines.resize(std::min(lines.size(), extent.height));
  if (extent.height < 4) return lines;
  lines.resize(extent.height - 1);
  const std::string last =
      view.typing ? "filter: " + harmless(view.filter) + "_" : std::string(kHints);
  lines.push_back(cut(last, extent.width));
  return lines;
}

}  // namespace mauve::ctl
