// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "protocol/in_words.h"
#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

std::string text_of(const Json& line, Look look) {
  const std::string text = harmless(protocol::line_in_words(line));
  if (text.empty()) return {};
  const char sign = text.front();
  const Paint paint = sign == '~' ? Paint::yellow : sign == '+' ? Paint::green : Paint::red;
  return painted(text.substr(0, 1), paint, look.colour) + text.substr(1) + "\n";
}

/// Why all members wait for each other, and in a plan the cost of it.
std::string at_barrier(const Json& result, bool planned, Look look) {
  if (word(result, "sync") != "barrier") return {};
  std::string names;
  for (const Json& name : list_in(result, "exchanged")) {
    join(names, harmless(compact(name)));
  }
  std::string text = "at a barrier";
  if (!names.empty()) text += ", for another contract of " + names;
  std::string costs;
  for (const Json& member : list_in(result, "components")) {
    const auto missed = whole_number(member, "missed");
    if (!planned || missed == 0) continue;
    join(costs, word(member, "name") + " " + counted(missed, "release"));
  }
  if (planned && !costs.empty()) text += "; may lose: " + costs;
  return wrapped(text, look.width, 2) + "\n";
}

std::string same_as(std::string_view file, const Json& result) {
  return std::string(file) + " is what runs (generation " + word(result, "generation") + ")\n";
}

}  // namespace

std::string change_lines(const Json& result, Look look) {
  std::string text;
  for (const Json& line : list_in(result, "lines")) text += text_of(line, look);
  return text;
}

std::string render_diff(std::string_view file, const Json& result, Look look) {
  std::string lines;
  for (const Json& line : list_in(result, "lines")) {
    lines += text_of(line, look);
    if (word(line, "kind") != "architecture" || lines.empty()) continue;
    // The name is the one part of a file that no change reaches.
    lines.insert(lines.size() - 1,
                 " (apply refuses this: keep the name, or start mauved with this file)");
  }
  const std::string notes = note_lines(result, look);
  if (lines.empty()) return same_as(file, result) + notes;
  return "--- what runs, generation " + word(result, "generation") + "\n+++ " + harmless(file) +
         "\n" + lines + notes;
}

std::string render_compared(std::uint64_t from, std::uint64_t to, const Json& result, Look look) {
  const std::string before = "generation " + std::to_string(from);
  const std::string after = "generation " + std::to_string(to);
  std::string how = harmless(word(result, "by_text"));
  if (!how.empty()) {
    how = wrapped(how + ", so the files are compared, without the defaults of plugins", look.width,
                  2) +
          "\n";
  }
  const std::string lines = change_lines(result, look);
  if (lines.empty()) return how + after + " is the same as " + before + "\n";
  return how + "--- " + before + "\n+++ " + after + "\n" + lines;
}

std::string render_applied(std::string_view file, const Json& result, Look look) {
  const std::string lines = change_lines(result, look);
  return lines + at_barrier(result, false, look) +
         render_receipt("applied " + harmless(file), result, look);
}

std::string render_plan(std::string_view file, const Json& result, Look look) {
  const std::string lines = change_lines(result, look);
  if (lines.empty()) return same_as(file, result) + remark_lines(result, look);
  std::string members;
  for (const Json& member : list_in(result, "components")) {
    join(members, word(member, "name"));
    const auto bytes = whole_number(member, "bytes");
    const std::string converted = word(member, "converted");
    if (!converted.empty()) {
      members += " (state converted: " + converted + ")";
    } else if (bytes > 0) {
      members += " (" + counted(bytes, "byte") + " of state kept)";
    } else if (mauve::ctl::member(member, "begins_anew") == true) {
      members += " (Stateless: begins anew)";
    }
  }
  std::string text = "everything is prepared and would be applied";
  if (!members.empty()) text += "; at the same instant: " + members;
  return lines + at_barrier(result, true, look) + wrapped(text, look.width, 2) + "\n" +
         remark_lines(result, look) + "nothing was changed (generation " +
         word(result, "generation") + " still running)\n";
}

}  // namespace mauve::ctl
