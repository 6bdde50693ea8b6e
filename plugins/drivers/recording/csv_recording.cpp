// SPDX-License-Identifier: LGPL-3.0-or-later
#include "csv_recording.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "csv_cell.h"

namespace drivers {
namespace {

using mauve::Errc;
using mauve::refuse;
using mauve::Result;
using mauve::Value;

/// A field of the type, with the names that lead to it.
struct Leaf {
  std::vector<std::string> path;
  bool is_text = false;

  [[nodiscard]] std::string name() const {
    std::string text;
    for (const std::string& one : path) text += "." + one;
    return text;
  }
};

/// A column of the address that is read.
struct Column {
  std::size_t index = 0;
  const Leaf* leaf = nullptr;
};

std::string text_of(const Value* value) {
  const auto* text = value == nullptr ? nullptr : value->get_if<std::string>();
  return text == nullptr ? std::string() : *text;
}

/// Each field of a nested struct is a leaf of its own, with its path. A list is one leaf, since the
/// client records it in one column.
void add_leaves(const Value& fields, const std::vector<std::string>& path,
                std::vector<Leaf>& leaves) {
  const auto* items = fields.get_if<Value::Array>();
  if (items == nullptr) return;
  for (const Value& field : *items) {
    std::vector<std::string> here = path;
    here.push_back(text_of(field.find("name")));
    const Value* kind = field.find("kind");
    if (kind != nullptr && kind->get_if<Value::Array>() != nullptr) {
      add_leaves(*kind, here, leaves);
      continue;
    }
    const std::string word = text_of(kind);
    const bool is_text = word == "string" || word == "duration" || word.starts_with("text[");
    leaves.push_back({std::move(here), is_text});
  }
}

void put(Value::Object& into, const std::vector<std::string>& path, std::size_t at, Value value) {
  if (at + 1 == path.size()) {
    into.emplace_back(path[at], std::move(value));
    return;
  }
  if (into.empty() || into.back().first != path[at]) into.emplace_back(path[at], Value::Object{});
  Value::Object inner = *into.back().second.get_if<Value::Object>();
  put(inner, path, at + 1, std::move(value));
  into.back().second = std::move(inner);
}

class CsvReader {
 public:
  CsvReader(const mauve::DataType& type, std::string address, std::string name)
      : type_(type), address_(std::move(address)), name_(std::move(name)) {
    add_leaves(type.describe(), {}, leaves_);
  }

  mauve::Status read_header(const std::vector<std::string>& cells) {
    if (cells[0] != "time_s") return wrong(1, "does not begin with the column \"time_s\"");
    for (std::size_t i = 1; i < cells.size(); ++i) {
      const Leaf* leaf = leaf_of(cells[i]);
      if (leaf == nullptr) continue;
      const std::string its = cells[i].substr(0, cells[i].size() - leaf->name().size());
      if (address_.empty()) address_ = its;
      if (its == address_) columns_.push_back({i, leaf});
      several_ = several_ || its != address_;
    }
    if (columns_.empty()) return wrong(1, "has no column of " + type_.name + " " + address_);
    if (several_ && !chosen_) return wrong(1, "has columns of several addresses");
    width_ = cells.size();
    return mauve::ok();
  }

  mauve::Status read_row(const std::vector<std::string>& cells, std::size_t line,
                         CsvRecording& recording) const {
    if (cells.size() != width_) return wrong(line, "has another number of cells than the header");
    Value::Object object;
    for (const Column& column : columns_) {
      const std::string& cell = cells[column.index];
      if (cell.empty() && !column.leaf->is_text) continue;
      auto value = column.leaf->is_text ? std::optional<Value>(cell) : value_of_cell(cell);
      if (!value) return wrong(line, "has a list that cannot be read");
      put(object, column.leaf->path, 0, *std::move(value));
    }
    const auto seconds = value_of_cell(cells[0]);
    const auto* time = seconds ? seconds->get_if<double>() : nullptr;
    if (time == nullptr || std::abs(*time) > 9e9) return wrong(line, "has no time");
    const std::int64_t at = std::llround(*time * 1e9);
    recording.first = line == 2 ? at : std::min(recording.first, at);
    recording.last = line == 2 ? at : std::max(recording.last, at);
    if (!is_empty(cells)) recording.rows.push_back({at, line, std::move(object)});
    return mauve::ok();
  }

  [[nodiscard]] mauve::Error wrong(std::size_t line, const std::string& message) const {
    return refuse(Errc::invalid_value, {}, name_ + ":" + std::to_string(line) + ": " + message,
                  "record the address with `mauvectl record ADDRESS -o FILE`; with several "
                  "addresses in a file, the property `address` says which one is played");
  }

 private:
  /// The row is of another address, or marks a gap.
  [[nodiscard]] bool is_empty(const std::vector<std::string>& cells) const {
    for (const Column& column : columns_) {
      if (!cells[column.index].empty()) return false;
    }
    return true;
  }

  /// The field that the name of a column ends in; with an address, all of the rest.
  [[nodiscard]] const Leaf* leaf_of(const std::string& column) const {
    const Leaf* longest = nullptr;
    for (const Leaf& leaf : leaves_) {
      const std::string name = leaf.name();
      const bool fits = chosen_ ? column == address_ + name : column.ends_with(name);
      if (fits && (longest == nullptr || leaf.path.size() > longest->path.size())) longest = &leaf;
    }
    return longest;
  }

  const mauve::DataType& type_;
  std::string address_;
  std::string name_;
  bool chosen_ = !address_.empty();
  std::vector<Leaf> leaves_;
  std::vector<Column> columns_;
  bool several_ = false;
  std::size_t width_ = 0;
};

}  // namespace

Result<CsvRecording> read_csv(std::string_view text, const mauve::DataType& type,
                              const std::string& address, const std::string& name) {
  CsvReader reader(type, address, name);
  CsvRecording recording;
  for (std::size_t next = 0; !text.empty();) {
    const std::size_t line = next + 1;
    const auto cells = take_row(text, next);
    if (!cells) return reader.wrong(line, "has a quote that is not closed");
    const auto done =
        line == 1 ? reader.read_header(*cells) : reader.read_row(*cells, line, recording);
    if (!done) return done.error();
  }
  if (recording.rows.empty()) return reader.wrong(1, "has no value of this address");
  return recording;
}

}  // namespace drivers
