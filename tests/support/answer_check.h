// SPDX-License-Identifier: LGPL-3.0-or-later
/// Whether an answer of mauved has the form that the row of its method states.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/methods.h"

namespace mauve::test {

/// Compares an answer with the fields of a row: a line for each field that no row names, that is
/// missing, or that has another type. Strict: later versions may add fields, this one may not.
class AnswerCheck {
 public:
  using Json = protocol::Json;
  using Fields = std::span<const protocol::Field>;

  void object(const std::string& at, Fields fields, const Json& object) {
    if (!object.is_object()) return add(at, "is no object: " + short_text(object));
    for (const auto& [name, value] : object.items()) {
      const auto field = std::ranges::find(fields, name, &protocol::Field::name);
      if (field == fields.end()) {
        add(at + "." + name, "is not in the row: " + short_text(value));
      } else {
        one(at + "." + name, field->type, value);
      }
    }
    for (const auto& field : fields) {
      if (!field.optional && !object.contains(field.name)) {
        add(at + "." + std::string(field.name), "is missing");
      }
    }
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(lines_); }

 private:
  using Type = protocol::Type;

  void one(const std::string& at, const Type& type, const Json& value) {
    if (!protocol::fits(value, type)) {
      return add(at, "is no " + protocol::in_words(type) + ": " + short_text(value));
    }
    if (type.record == nullptr || value.is_null()) return;
    if (type.shape == Type::Shape::one) return object(at, type.record->fields, value);
    for (const auto& item : value) object(at + "[]", type.record->fields, item);
  }
  void add(const std::string& at, const std::string& what) { lines_.push_back(at + " " + what); }
  static std::string short_text(const Json& value) { return value.dump().substr(0, 80); }

  std::vector<std::string> lines_;
};

/// Empty: the answer fits the row.
inline std::vector<std::string> misfits(const protocol::Method& method,
                                        const protocol::Json& answer) {
  AnswerCheck check;
  check.object(std::string(method.name), protocol::all_answer_fields(method), answer);
  return check.take();
}

}  // namespace mauve::test
