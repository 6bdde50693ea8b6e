// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/timeline.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "mtrace/timeline_page.h"
#include "mtrace/timeline_rows.h"
#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

constexpr double kLabel = 15.0;  // pixels a line of labels is high
constexpr std::size_t kLabelLines = 4;
constexpr std::size_t kMostLines = 200;

double pitch_for(std::size_t rows) {
  if (rows <= 8) return 66.0;
  return rows <= 16 ? 50.0 : 36.0;
}

/// Changes whose text finds room in one of a few lines above the rows; else the tooltip shows it.
class Labels {
 public:
  /// Where the baseline of the text is, or nothing.
  std::optional<double> place(double x, const std::string& text, double bottom) {
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      if (ends_[i] > x) continue;
      ends_[i] = x + text_width(text, kLabelSize) + 14.0;
      return bottom - 6.0 - kLabel * static_cast<double>(i);
    }
    return std::nullopt;
  }

 private:
  std::vector<double> ends_ = std::vector<double>(kLabelLines, 0.0);
};

/// The events that concern several components at once: changes, rollbacks, disturbances.
class Happenings {
 public:
  Happenings(Page& page, const Trace& trace, Scene& scene)
      : page_(page), trace_(trace), scene_(scene) {}

  void draw_behind() {
    std::size_t drawn = 0;
    for_each([&](const Record& record) {
      if (record.event != Event::disturbed) return;
      const double from = page_.x(record.time - record.a);
      const double to = page_.x(record.time);
      if (to < page_.left || from > page_.right) return;
      if (++drawn > kMostLines) return;
      page_.svg.rectangle({from, page_.top}, std::max(1.5, to - from), page_.bottom - page_.top,
                          "class=\"disturbed\"",
                          "the host, or something foreign, held a CPU up for " +
                              nanoseconds_in_words(static_cast<double>(record.a)));
      page_.occurs(Sign::disturbed);
    });
    note_rest(drawn, "disturbance");
  }

  void draw_in_front() {
    std::size_t drawn = 0;
    for_each([&](const Record& record) {
      const bool commit = record.event == Event::commit;
      const bool rollback = record.event == Event::rollback;
      if (!commit && !rollback && record.event != Event::abort) return;
      const std::int64_t at = record.a == kNoInstant ? record.time : record.a;
      if (at < scene_.from || at > scene_.to || ++drawn > kMostLines) return;
      draw_line(record, at);
    });
    note_rest(drawn, "change");
  }

 private:
  template <typename Use>
  void for_each(Use use) {
    for (const Lane& lane : scene_.lanes) {
      if (lane.component != nullptr) continue;
      for (const Record* mark : lane.marks) use(*mark);
    }
  }

  void draw_line(const Record& record, std::int64_t at) {
    const std::string kind = record.event == Event::commit     ? "commit"
                             : record.event == Event::rollback ? "rollback"
                                                               : "aborted";
    const Sign sign = record.event == Event::commit     ? Sign::commit
                      : record.event == Event::rollback ? Sign::rollback
                                                        : Sign::aborted;
    const double x = page_.x(at);
    const std::string& what = trace_.text(record.name);
    const std::string text = (record.event == Event::commit ? "change " : kind + " ") +
                             std::to_string(record.b) + (what.empty() ? "" : ": " + what);
    const auto y = labels_.place(x, text, page_.top);
    page_.svg.path(
        path_step('M', {x, y.value_or(page_.top - 4) - 9}) + path_step('L', {x, page_.bottom}),
        "class=\"" + kind + "\"",
        text + "\ninstant " + instant_in_words(at) + "\ndecided " + instant_in_words(record.time));
    if (y) page_.svg.text({x + 4, *y}, text, "class=\"label " + kind + "\"");
    page_.occurs(sign);
  }

  void note_rest(std::size_t drawn, std::string_view noun) {
    if (drawn <= kMostLines) return;
    scene_.left_out.push_back(counted(drawn - kMostLines, noun));
  }

  Page& page_;
  const Trace& trace_;
  Scene& scene_;
  Labels labels_;
};

/// From prepare to commit, on a row of its own at the bottom: the R of the paper's figures.
void draw_control(Page& page, const Trace& trace, const Scene& scene, double baseline) {
  const auto thread = trace.find(kControl);
  const Record* prepared = nullptr;
  for (const Record& record : trace.records) {
    if (!thread || record.thread != *thread) continue;
    if (record.event == Event::prepare) prepared = &record;
    const bool ends = record.event == Event::commit || record.event == Event::abort;
    // One that was refused behind its preparation has no end.
    if (!ends || prepared == nullptr || prepared->name != record.name) continue;
    if (record.time >= scene.from && prepared->time <= scene.to) {
      const double from = std::max(page.left, page.x(prepared->time));
      const double to = std::min(page.right, page.x(record.time));
      const std::string& what = trace.text(record.name);
      page.svg.rectangle(
          {from, baseline - 16}, std::max(1.5, to - from), 16, "class=\"prepare\"",
          "prepared " + what + " in " +
              nanoseconds_in_words(static_cast<double>(record.time - prepared->time)));
      if (to - from > text_width(what, kLabelSize) + 8.0) {
        page.svg.text({(from + to) / 2, baseline - 4}, what,
                      "text-anchor=\"middle\" class=\"label\"");
      }
      page.occurs(Sign::prepare);
    }
    prepared = nullptr;
  }
}

/// Changes that the picture shows, prepared or in force.
std::size_t changes_in(const Trace& trace, const Scene& scene) {
  const auto thread = trace.find(kControl);
  if (!thread) return 0;
  const auto is_one = [&](const Record& one) {
    const bool decides =
        one.event == Event::commit || one.event == Event::rollback || one.event == Event::abort;
    const std::int64_t at = std::max(one.time, one.a);
    return one.thread == *thread && decides && at >= scene.from && one.time <= scene.to;
  };
  return static_cast<std::size_t>(
      std::count_if(trace.records.begin(), trace.records.end(), is_one));
}

/// As exact as the picture is: 0.6162 s of half a second.
std::string seconds_for(std::int64_t time, std::int64_t range) {
  int digits = 0;
  for (std::int64_t step = 1'000'000'000; step > range / 1000 && digits < 9; step /= 10) ++digits;
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, static_cast<double>(time) / 1e9);
  return text.data();
}

std::string title_of(const Trace& trace, const Scene& scene) {
  std::string title = trace.header.architecture.empty() ? "mauve" : trace.header.architecture;
  const std::int64_t range = scene.to - scene.from;
  title += ": " + counted(scene.rows.size(), "component") + ", " + seconds_for(scene.from, range) +
           " s to " + seconds_for(scene.to, range) + " s since T0";
  const std::string& why = trace.header.why;
  if (!why.empty() && why != "command") title += " (kept because: " + why + ")";
  return title;
}

/// A row has one label: that of the end.
void report_former_labels(Scene& scene) {
  for (const Row& row : scene.rows) {
    const Component& component = *row.lane->component;
    const std::int64_t since =
        std::max(component.scheduled.value_or(scene.from), component.timed.value_or(scene.from));
    if (since <= scene.from) continue;
    scene.left_out.push_back("the priority, CPU and period of " + component.name + " before " +
                             instant_in_words(since) + ", which may be others than its row says");
  }
}

void report_reading(const Trace& trace, Scene& scene) {
  if (scene.without_arrows > 0) {
    scene.left_out.push_back("the releases of " + counted(scene.without_arrows, "component") +
                             ", whose arrows would touch");
  }
  if (std::ranges::all_of(scene.rows, [](const Row& row) { return row.boxes.empty(); })) {
    scene.left_out.push_back(
        "jobs, since none ran: the components stand, or a thread of another program keeps them "
        "from their processor (mauvectl doctor)");
  }
  if (!trace.reading.complete) scene.left_out.push_back("the file was cut off");
  if (trace.header.lost > 0) {
    scene.left_out.push_back(counted(trace.header.lost, "record") + " that were lost");
  }
}

}  // namespace

Timeline draw_timeline(const Trace& trace, const View& view) {
  Scene scene = scene_of(trace, view, 1.0 / Page::kInner);
  const double pitch = pitch_for(scene.rows.size());
  const std::size_t changes = changes_in(trace, scene);
  const bool control = changes > 0;
  const double rows = static_cast<double>(std::max<std::size_t>(1, scene.rows.size()));
  const double labels = static_cast<double>(std::min(changes, kLabelLines));
  const double above = 44.0 + kLabel * labels;
  const double bottom = above + pitch * rows + (control ? 30.0 : 8.0);
  Page page(trace, scene, above, bottom);
  Happenings runtime_events(page, trace, scene);
  runtime_events.draw_behind();
  page.draw_axis();
  double baseline = above;
  for (const Row& row : scene.rows) {
    baseline += pitch;
    RowPicture(page, trace, scene, row, {baseline - 0.22 * pitch, 0.42 * pitch}).draw();
  }
  if (control) {
    page.draw_baseline(bottom, "[control]", "prepares changes");
    draw_control(page, trace, scene, bottom);
  }
  runtime_events.draw_in_front();
  report_former_labels(scene);
  report_reading(trace, scene);
  std::string file = page.file(title_of(trace, scene), scene.left_out);
  return {std::move(file), scene.from, scene.to, std::move(scene.left_out)};
}

}  // namespace mauve::ctl::mtrace
