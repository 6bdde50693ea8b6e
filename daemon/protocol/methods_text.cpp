// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/methods_text.h"

#include <span>
#include <string_view>

#include "protocol/openrpc.h"

namespace mauve::protocol {
namespace {

std::string heading(std::string_view name) { return "\n### " + std::string(name) + "\n\n"; }

std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

/// A table of three columns; `mark` stands behind the type of an optional field.
std::string table_of(std::span<const Field> fields, const std::string& title,
                     std::string_view mark) {
  std::string text = "| " + title + " | type | meaning |\n|---|---|---|\n";
  for (const Field& field : fields) {
    text += "| " + code(field.name) + " | " + in_words(field.type);
    if (field.optional) text += std::string(mark);
    text += " | " + sentence_of(field) + " |\n";
  }
  return text;
}

std::string effects_table() {
  std::string text = "| effect | meaning |\n|---|---|\n";
  for (const Effect effect : effects()) {
    text += "| " + code(to_string(effect)) + " | " + std::string(text_of(effect)) + ". |\n";
  }
  return text;
}

constexpr std::string_view kTypes =
    "A `count` is an integer of 0 or more. A `duration` is a text, a number and a unit such as "
    "`50ms`. A `time` is a text, an instant in UTC such as `2026-01-31T12:00:00Z`. A `value` is "
    "any "
    "JSON value. A map of some type is an object whose members all have that type. A type that "
    "begins with a capital letter is a record, described below the methods.\n";
constexpr std::string_view kAbsent = ", may be absent";

}  // namespace

std::string in_markdown(const Method& method) {
  std::string text = std::string(method.help) + ". Role " + code(to_string(method.role)) +
                     ", effect " + code(to_string(method.effect)) + ".\n\n";
  if (!method.params.empty()) text += table_of(method.params, "parameter", kAbsent) + "\n";
  return text + "The answer:\n\n" + table_of(method.answer, "field", kAbsent);
}

std::string methods_in_markdown() {
  std::string text =
      "The role is the lowest one that may call a method: `viewer`, `operator` or `admin`. The "
      "effect states how the method acts on the running system:\n\n" +
      effects_table() + "\n" + std::string(kTypes) +
      "\nA mutation is a method with the effect `changes`, `adjusts`, `ends` or `stops`. Every "
      "mutation also takes these parameters:\n\n" +
      table_of(every_mutation_takes(), "parameter", kAbsent) +
      "\nThe answer of every mutation also has these fields:\n\n" +
      table_of(every_mutation_answers(), "field", kAbsent);
  for (const Method& method : methods()) text += heading(method.name) + in_markdown(method);
  text +=
      heading("Records") +
      "Several answers hold objects of the same kind: a field of the type \"list of Line\" holds "
      "objects with the fields of the record Line.\n";
  for (const Record* record : records_in(methods())) {
    text += heading(record->name) + std::string(record->text) + ".\n\n" +
            table_of(record->fields, "field", kAbsent);
  }
  return text;
}

}  // namespace mauve::protocol
