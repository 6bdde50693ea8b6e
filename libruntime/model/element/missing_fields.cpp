// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/element/missing_fields.h"

#include <string_view>
#include <vector>

namespace mauve {
namespace {

using Names = std::vector<std::string>;

/// Adds the fields that `given` leaves out. `kind` is as DataType::describe() returns it. Unless
/// `whole`, only items of arrays must name their fields.
void add_missing(const std::string& at, const Value& kind, const Value& given, bool whole,
                 Names& names) {
  if (const auto* const fields = kind.get_if<Value::Array>()) {
    for (const Value& field : *fields) {
      const auto& name = *field.find("name")->get_if<std::string>();
      const std::string path = at.empty() ? name : at + "." + name;
      if (const Value* const member = given.find(name)) {
        add_missing(path, *field.find("kind"), *member, whole, names);
      } else if (whole) {
        names.push_back(path);
      }
    }
    return;
  }
  const Value* const item = kind.find("array");
  const auto* const items = given.get_if<Value::Array>();
  if (item == nullptr || items == nullptr) return;
  for (std::size_t i = 0; i < items->size(); ++i) {
    add_missing(at + "[" + std::to_string(i) + "]", *item, (*items)[i], true, names);
  }
}

std::string in_words(const Names& names) {
  constexpr std::size_t kNamed = 8;
  std::string words = names.size() == 1 ? "the field " : "the fields ";
  for (std::size_t i = 0; i < names.size() && i < kNamed; ++i) {
    words += (i == 0 ? "" : ", ") + names[i];
  }
  return names.size() > kNamed ? words + " and " + std::to_string(names.size() - kNamed) + " more"
                               : words;
}

Status refuse_missing(const std::string& at, const DataType& type, const Value& given, bool whole,
                      const std::string& hint) {
  Names names;
  const Value kind = type.describe == nullptr ? Value() : type.describe();
  add_missing("", kind, given, whole, names);
  if (names.empty()) return ok();
  const bool has_name = kind.get_if<Value::Array>() != nullptr;  // a structure, not an array
  return refuse({Errc::invalid_value, "fields_missing"}, at,
                "the value leaves out " + in_words(names) + (has_name ? " of " + type.name : ""),
                hint);
}

}  // namespace

Status names_all_fields(const std::string& at, const DataType& type, const Value& given,
                        const std::string& hint) {
  return refuse_missing(at, type, given, true, hint);
}

Status items_name_all_fields(const std::string& at, const DataType& type, const Value& given) {
  return refuse_missing(at, type, given, false,
                        "mauvectl get " + at + " prints the value in force, with all fields");
}

}  // namespace mauve
