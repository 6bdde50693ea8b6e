// SPDX-License-Identifier: LGPL-3.0-or-later
/// One component of a timeline: its boxes, arrows and marks on a baseline.
#pragma once

#include <string>

#include "mtrace/timeline_page.h"

namespace mauve::ctl::mtrace {

class RowPicture {
 public:
  struct Place {
    double baseline;
    double height;  ///< of its boxes
  };

  RowPicture(Page& page, const Trace& trace, Scene& scene, const Row& row, Place place);

  void draw();

 private:
  void draw_box(const Box& box);
  void draw_state_name(const Box& box, double from, double to);
  void draw_holds();
  void draw_releases();
  void draw_release(const Job& job);
  void draw_late(const Job& job);
  void draw_marks();
  void draw_mark(const Record& mark);
  void draw_missed(const Job& before);
  void draw_stops();
  void arrow(std::int64_t time, bool up, Sign sign, std::string_view title);
  void wrong(std::int64_t time, std::string_view words);
  [[nodiscard]] std::string words_of_box(const Box& box) const;

  Page& page_;
  const Trace& trace_;
  Scene& scene_;
  const Row& row_;
  const Component& component_;
  Place place_;
  double last_text_end_ = 0.0;  // where the last words in red end
};

}  // namespace mauve::ctl::mtrace
