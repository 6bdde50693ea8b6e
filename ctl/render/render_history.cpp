// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

Paint paint_of_mark(const std::string& mark) {
  if (mark == "confirmed") return Paint::plain;
  return mark == "damaged" ? Paint::red : Paint::yellow;
}

}  // namespace

std::string render_history(const Json& result, Look look) {
  if (word(result, "state_dir") == "-") {
    return "nothing is kept: mauved runs without --state-dir\n";
  }
  const Json items = result.is_object() ? result.value("items", Json::array()) : Json::array();
  if (items.empty()) return "none\n";
  Table table({{"GENERATION", true},
               {"TIME"},
               {"UID", true},
               {"COMMAND"},
               {"MARK"},
               {"CHANGES"},
               {"REASON"}});
  for (const Json& one : items) {
    const std::string mark = word(one, "mark");
    table.add({{word(one, "generation")},
               {time_in_words(word(one, "time"))},
               {word(one, "command") == "supervision" ? "-" : word(one, "uid")},
               {word(one, "command")},
               {mark, paint_of_mark(mark)},
               {word(one, "changes")},
               {word(one, "reason")}});
  }
  return table.text(look.width, look.colour);
}

}  // namespace mauve::ctl
