// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/timeline_rows.h"

#include <algorithm>
#include <cmath>

#include "base/duration.h"
#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

constexpr double kNarrowest = 0.8;        // pixels of a box
constexpr std::size_t kMostArrows = 200;  // with five pixels between
constexpr std::size_t kMostMarks = 200;
constexpr std::int64_t kMostMissed = 50;

std::string short_words(std::int64_t ns) { return nanoseconds_in_words(static_cast<double>(ns)); }

std::string attributes_of(const Component& component) {
  std::string words = component.realtime ? "priority " + std::to_string(component.priority)
                                         : std::string("ordinary");
  if (const auto cpu = component.cpu()) words += ", CPU " + std::to_string(*cpu);
  if (component.period > 0) {
    words += ", " + format_duration(std::chrono::nanoseconds(component.period));
  }
  return words;
}

std::string class_of(std::string_view name) { return "class=\"" + std::string(name) + "\""; }

}  // namespace

RowPicture::RowPicture(Page& page, const Trace& trace, Scene& scene, const Row& row, Place place)
    : page_(page),
      trace_(trace),
      scene_(scene),
      row_(row),
      component_(*row.lane->component),
      place_(place) {}

void RowPicture::draw() {
  page_.draw_baseline(place_.baseline, component_.name, attributes_of(component_));
  draw_stops();
  page_.svg.open_clip({page_.left, page_.top}, page_.right - page_.left, page_.bottom - page_.top);
  for (const Box& box : row_.boxes) draw_box(box);
  if (!row_.dense) draw_holds();
  page_.svg.close_clip();
  draw_releases();
  draw_marks();
}

void RowPicture::draw_box(const Box& box) {
  const double from = page_.x(box.from);
  const double to = std::max(page_.x(box.to), from + kNarrowest);
  std::string name = "job";
  switch (box.piece) {
    case Piece::runs:
      name = "state " + page_.colour_of(box.state);
      break;
    case Piece::job:
      page_.occurs(Sign::job);
      break;
    case Piece::many:
      name = "many";
      page_.occurs(Sign::many);
      break;
    case Piece::preempted:
      name = "preempted";
      page_.occurs(Sign::preempted);
      break;
    case Piece::blocked:
      name = "blocked";
      page_.occurs(Sign::blocked);
      break;
  }
  page_.svg.rectangle({from, place_.baseline - place_.height}, to - from, place_.height,
                      class_of(name), words_of_box(box));
  if (box.piece == Piece::runs) draw_state_name(box, from, to);
}

void RowPicture::draw_state_name(const Box& box, double from, double to) {
  const std::string& name = trace_.text(box.state);
  const double left = std::max(from, page_.left);
  const double right = std::min(to, page_.right);
  if (right - left < text_width(name, kLabelSize) + 6.0) return;
  page_.svg.text({(left + right) / 2, place_.baseline - place_.height / 2 + 4}, name,
                 "text-anchor=\"middle\" font-size=\"11\"");
}

std::string RowPicture::words_of_box(const Box& box) const {
  std::string words = component_.name;
  if (box.piece == Piece::many) return words + ": " + counted(box.count, "job");
  if (box.piece != Piece::job) words += ": " + trace_.text(box.state);
  if (box.piece == Piece::preempted) words += ", preempted";
  if (box.piece == Piece::blocked) words += ", waits for a lock";
  words += "\n" + instant_in_words(box.from) + ", " + short_words(box.to - box.from);
  if (box.job == nullptr) return words;
  words += "\njob released for " + instant_in_words(box.job->release) + ", began " +
           short_words(box.job->from - box.job->release) + " later";
  if (box.job->whole) words += ", response " + short_words(box.job->to - box.job->release);
  return words;
}

void RowPicture::draw_holds() {
  std::size_t drawn = 0;
  for (const Span& hold : row_.lane->holds) {
    if (hold.to < scene_.from || hold.from > scene_.to || ++drawn > kMostArrows) continue;
    const double from = page_.x(hold.from);
    const double width = std::max(page_.x(hold.to) - from, 1.0);
    const std::string& name = trace_.text(hold.name);
    page_.svg.rectangle(
        {from, place_.baseline + 1.5}, width, 3.5, class_of("held"),
        component_.name + " holds " + name + " for " + short_words(hold.to - hold.from));
    if (width > text_width(name, kSmallSize)) {
      page_.svg.text({from, place_.baseline + 13}, name, "class=\"small\"");
    }
    page_.occurs(Sign::held);
  }
  if (drawn > kMostArrows) {
    scene_.left_out.push_back(counted(drawn - kMostArrows, "lock") + " of " + component_.name);
  }
}

/// As in the paper: an arrow up where it is released, by its logical clock.
void RowPicture::draw_releases() {
  std::size_t visible = 0;
  for (const Job& job : row_.lane->jobs) visible += page_.shows(job.release) ? 1 : 0;
  const bool all = visible <= kMostArrows;
  if (!all) ++scene_.without_arrows;
  std::size_t late = 0;
  for (const Job& job : row_.lane->jobs) {
    if (all && page_.shows(job.release)) draw_release(job);
    if (job.late > 0 && job.to >= scene_.from && job.from <= scene_.to && ++late <= kMostMarks) {
      draw_late(job);
    }
    if (job.missed > 0) draw_missed(job);
  }
  // The release that waits behind the last job.
  if (all && !row_.lane->jobs.empty()) {
    const Job& last = row_.lane->jobs.back();
    const bool waits = last.whole && last.missed == 0;
    if (waits && page_.shows(last.next)) arrow(last.next, true, Sign::release, "release");
  }
}

void RowPicture::draw_release(const Job& job) {
  arrow(job.release, true, Sign::release,
        "release of " + component_.name + " for " + instant_in_words(job.release));
  const std::int64_t deadline = job.release + component_.deadline;
  if (component_.deadline > 0 && page_.shows(deadline)) {
    arrow(deadline, false, Sign::deadline, "deadline of " + component_.name);
  }
}

void RowPicture::draw_late(const Job& job) {
  const double from = std::max(page_.left, page_.x(job.to - job.late));
  const double to = std::min(page_.right, page_.x(job.to));
  if (to < from) return;
  page_.svg.rectangle({from, place_.baseline - place_.height}, std::max(1.5, to - from),
                      place_.height, class_of("overrun"),
                      component_.name + " ended " + short_words(job.late) + " after its deadline");
  page_.occurs(Sign::overrun);
}

void RowPicture::arrow(std::int64_t time, bool up, Sign sign, std::string_view title) {
  const double x = page_.x(time);
  const double high = place_.baseline - place_.height * 1.38;
  const double tip = up ? high : place_.baseline;
  const double wing = up ? 4.5 : -4.5;
  const std::string_view name = sign == Sign::release    ? "release"
                                : sign == Sign::deadline ? "deadline"
                                                         : "missed";
  page_.svg.path(path_step('M', {x, up ? place_.baseline : high}) + path_step('L', {x, tip}) +
                     path_step('M', {x - 2.8, tip + wing}) + path_step('L', {x, tip}) +
                     path_step('L', {x + 2.8, tip + wing}),
                 class_of(name), title);
  page_.occurs(sign);
}

void RowPicture::draw_marks() {
  std::size_t drawn = 0;
  for (const Record* mark : row_.lane->marks) {
    if (!page_.shows(mark->time)) continue;
    if (++drawn <= kMostMarks) draw_mark(*mark);
  }
  if (drawn > kMostMarks) {
    scene_.left_out.push_back(counted(drawn - kMostMarks, "mark") + " of " + component_.name);
  }
}

void RowPicture::draw_mark(const Record& mark) {
  const double x = page_.x(mark.time);
  const double y = place_.baseline;
  const std::string at = "\n" + instant_in_words(mark.time);
  const std::string& name = trace_.text(mark.name);
  switch (mark.event) {
    case Event::fault:
      page_.svg.path(path_step('M', {x - 6, y - 16}) + path_step('L', {x + 6, y - 4}) +
                         path_step('M', {x + 6, y - 16}) + path_step('L', {x - 6, y - 4}),
                     class_of("fault"), component_.name + ": " + name + at);
      wrong(mark.time, name.empty() ? "fault" : name);
      return page_.occurs(Sign::fault);
    case Event::missed:
      return wrong(mark.time, std::to_string(mark.a) + " missed");
    case Event::user:
      page_.svg.circle({x, y - place_.height - 5}, 2.6, class_of("user"),
                       name + " = " + compact(protocol::Json(mark.value())) + at);
      return page_.occurs(Sign::user);
    case Event::applied:
      page_.svg.path(path_step('M', {x, y - 6}) + path_step('L', {x + 5, y}) +
                         path_step('L', {x, y + 6}) + path_step('L', {x - 5, y}) + "Z",
                     class_of("applied"),
                     component_.name + " takes change " + std::to_string(mark.b) +
                         (name.empty() ? "" : " (" + name + ")") + at + "\ninstant " +
                         (mark.a == kNoInstant ? "none" : instant_in_words(mark.a)));
      return page_.occurs(Sign::applied);
    case Event::lost:
      return wrong(mark.time, counted(static_cast<std::uint64_t>(std::max<std::int64_t>(0, mark.a)),
                                      "record") +
                                  " lost");
    default:
      return;
  }
}

/// The releases for which no job ran, because the job before took too long.
void RowPicture::draw_missed(const Job& before) {
  const std::int64_t wait = before.next - before.release;
  for (std::int64_t i = 0; wait > 0 && i < std::min(before.missed, kMostMissed); ++i) {
    const std::int64_t release = before.next + i * wait;
    if (!page_.shows(release)) continue;
    arrow(release, true, Sign::missed, "missed release for " + instant_in_words(release));
  }
}

/// Draws a failure in red above the boxes, where there is room.
void RowPicture::wrong(std::int64_t time, std::string_view words) {
  const double x = page_.x(time) + 4;
  if (x < last_text_end_ || row_.dense) return;
  last_text_end_ = x + text_width(words, kLabelSize) + 6;
  page_.svg.text({x, place_.baseline - place_.height * 1.12}, words, "class=\"label wrong\"");
}

void RowPicture::draw_stops() {
  const Record* stopped = nullptr;
  const auto draw_until = [&](std::int64_t time) {
    const double from = std::clamp(page_.x(stopped->time), page_.left, page_.right);
    const double to = std::clamp(page_.x(time), page_.left, page_.right);
    if (to > from) {
      page_.svg.path(
          path_step('M', {from, place_.baseline}) + path_step('L', {to, place_.baseline}),
          class_of("stopped"), component_.name + " is stopped");
      page_.occurs(Sign::stopped);
    }
    stopped = nullptr;
  };
  for (const Record* mark : row_.lane->marks) {
    if (mark->event == Event::stopped) stopped = mark;
    if (mark->event == Event::started && stopped != nullptr) draw_until(mark->time);
  }
  if (stopped != nullptr) draw_until(scene_.to);
}

}  // namespace mauve::ctl::mtrace
