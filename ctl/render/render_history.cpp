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

/// A rollback that mauved makes by itself is recorded like the mark of the change that it undoes.
std::string command_of(const Json& one) {
  const std::string command = word(one, "command");
  return command == "rolled_back" ? "rollback by mauved" : command;
}

}  // namespace

std::string render_history(const Json& result, Look look) {
  if (word(result, "state_dir") == "-") {
    return "nothing is kept: mauved runs without --state-dir\n";
  }
  const Json items = result.is_object() ? result.value("items", Json::array()) : Json::array();
  if (items.empty()) return "none\n";
  Table table(
      {{"GENERATION", true}, {"TIME"}, {"USER"}, {"COMMAND"}, {"MARK"}, {"CHANGES"}, {"REASON"}});
  for (const Json& one : items) {
    const std::string mark = word(one, "mark");
    table.add({{word(one, "generation")},
               {time_in_words(word(one, "time"))},
               {word(one, "command") == "supervision" ? "none" : user_in_words(one)},
               {command_of(one)},
               {mark, paint_of_mark(mark)},
               {word(one, "changes")},
               {word(one, "reason")}});
  }
  return table.text(look.width, look.colour);
}

}  // namespace mauve::ctl
