// SPDX-License-Identifier: LGPL-3.0-or-later
/// Answers as the rows of the table of methods describe them.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/size.h"
#include "protocol/methods.h"
#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::Field;
using protocol::Type;

bool is_number(const Type& type) {
  const bool number = type.kind == Type::Kind::count || type.kind == Type::Kind::integer ||
                      type.kind == Type::Kind::number;
  return number && type.shape == Type::Shape::one;
}

bool is_table(const Field& field) {
  return field.type.kind == Type::Kind::record && field.type.shape == Type::Shape::list;
}

std::string in_unit(const Json& value, const Type& type) {
  if (!value.is_number() || type.unit.empty()) return compact(value);
  const auto amount = value.get<double>();
  if (type.unit == "ns") return nanoseconds_in_words(amount);
  if (type.unit == "s") return seconds_in_words(amount);
  if (type.unit == "bytes") return format_size(static_cast<std::uint64_t>(amount));
  return compact(value) + " " + std::string(type.unit);
}

std::string content_of(const Json& object, const Field& field) {
  if (!object.contains(field.name)) return {};
  const Json& value = member(object, field.name);
  if (value.is_null()) return "-";
  if (field.type.shape != Type::Shape::list || !value.is_array()) {
    return harmless(in_unit(value, field.type));
  }
  std::string all;
  for (const Json& item : value) join(all, harmless(in_unit(item, field.type)));
  return all;
}

std::string title_of(const Field& field, bool of_column) {
  std::string title(field.name);
  // The value is printed with its unit.
  const std::string unit = field.type.unit.empty() ? "" : "_" + std::string(field.type.unit);
  if ((unit == "_ns" || unit == "_s") && title.ends_with(unit)) {
    title.resize(title.size() - unit.size());
  }
  std::ranges::replace(title, '_', ' ');
  if (!of_column) return title;
  std::ranges::transform(title, title.begin(), [](char letter) {
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  });
  return title;
}

std::string table_of(std::span<const Field> fields, const Json& items, Look look) {
  if (items.empty()) return "none\n";
  // A row names the important fields first: the last ones are left out where not all fit.
  std::vector<Column> columns;
  for (const Field& field : fields) {
    const auto rank = static_cast<int>(columns.size());
    columns.push_back({title_of(field, true), is_number(field.type), rank});
  }
  Table table(std::move(columns));
  for (const Json& item : items) {
    std::vector<Cell> row;
    for (const Field& field : fields) row.push_back({content_of(item, field)});
    table.add(std::move(row));
  }
  return table.text(look.width, look.colour);
}

}  // namespace

std::string render_answer(const protocol::Method& method, const Json& answer, Look look) {
  std::string lines;
  std::string tables;
  for (const Field& field : method.answer) {
    if (!is_table(field)) {
      if (answer.contains(field.name)) {
        lines += title_of(field, false) + ": " + content_of(answer, field) + "\n";
      }
      continue;
    }
    if (method.answer.size() > 1) {
      tables += painted(title_of(field, false), Paint::bold, look.colour) + "\n";
    }
    const Json& items = member(answer, field.name);
    tables += table_of(field.type.record->fields, items.is_array() ? items : Json::array(), look);
  }
  return lines + tables;
}

}  // namespace mauve::ctl
