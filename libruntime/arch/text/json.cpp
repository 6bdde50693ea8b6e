// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/json.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "arch/text/json_hint.h"
#include "arch/text/token_places.h"

namespace mauve::arch {
namespace {

// "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while parsing
// value - unexpected ']'; last read: '[]'" becomes "syntax error while parsing value - unexpected
// ']'". The last read text is left out: it may hold any bytes, and the place already shows it.
std::string plain_message(std::string text) {
  if (const std::size_t prefix = text.find("] "); prefix != std::string::npos) {
    text.erase(0, prefix + 2);
  }
  const std::size_t colon = text.find(": ");
  if (text.starts_with("parse error") && colon != std::string::npos) text.erase(0, colon + 2);
  const std::size_t read = text.find("; last read: '");
  const std::size_t quote = text.rfind('\'');
  if (read != std::string::npos && quote > read) {
    const std::size_t expected = text.rfind("'; expected ");
    const std::size_t end = expected == std::string::npos || expected < read ? quote : expected;
    text.erase(read, end + 1 - read);
  }
  return text;
}

// Builds the tree from the parser's events. Its member functions have the names that the parser
// calls; returning false ends the parse.
class TreeBuilder {
 public:
  TreeBuilder(std::string_view text, Problems& problems, const JsonLimits& limits)
      : text_(text), places_(text), problems_(problems), limits_(limits) {}

  bool null() { return put(std::monostate{}); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(nlohmann::json::number_integer_t value) { return put(std::int64_t{value}); }
  bool number_unsigned(nlohmann::json::number_unsigned_t value) {
    if (std::in_range<std::int64_t>(value)) return put(static_cast<std::int64_t>(value));
    return put(std::uint64_t{value});
  }
  bool number_float(nlohmann::json::number_float_t value, const std::string&) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(nlohmann::json::binary_t&) { return false; }

  bool start_object(std::size_t) { return open(Node::Object{}); }
  bool start_array(std::size_t) { return open(Node::Array{}); }
  bool end_object() {
    report_duplicates(std::get<Node::Object>(open_.back()->content));
    return close();
  }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    auto& members = std::get<Node::Object>(open_.back()->content);
    members.push_back({std::move(name), places_.next(), {}});
    return true;
  }

  bool parse_error(std::size_t offset, const std::string&, const nlohmann::json::exception& error) {
    const std::size_t last = offset == 0 ? 0 : offset - 1;
    const std::string message = plain_message(error.what());
    return stop(TokenPlaces::place_of(text_, last), {Errc::invalid_value, "json_syntax"}, message,
                json_hint(message, text_, last));
  }

  [[nodiscard]] bool refused() const { return refused_; }
  [[nodiscard]] Node take() { return std::move(root_); }

 private:
  static std::string shown(const std::string& name) {
    return name.size() <= 64 ? name : name.substr(0, 64) + "...";
  }

  void report_duplicates(const Node::Object& members) {
    std::vector<const Member*> sorted;
    sorted.reserve(members.size());
    for (const Member& member : members) sorted.push_back(&member);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Member* a, const Member* b) { return a->key < b->key; });
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      if (sorted[i]->key != sorted[i - 1]->key) continue;
      problems_.add(sorted[i]->where, {Errc::duplicate, "file_says_twice"}, "",
                    "the key \"" + shown(sorted[i]->key) + "\" appears twice",
                    "it is already in line " + std::to_string(sorted[i - 1]->where.line));
    }
  }

  bool stop(Position where, Reason reason, std::string message, std::string hint = {}) {
    refused_ = true;
    problems_.add(where, reason, "", std::move(message), std::move(hint));
    return false;
  }

  // The slot that the next value fills: behind the last key, at the end of the array, or the root.
  Node& slot() {
    if (open_.empty()) return root_;
    if (auto* items = std::get_if<Node::Array>(&open_.back()->content)) {
      return items->emplace_back();
    }
    return std::get<Node::Object>(open_.back()->content).back().value;
  }

  template <typename T>
  bool put(T content) {
    const Position where = places_.next();
    slot() = Node{where, std::move(content)};
    return true;
  }

  template <typename T>
  bool open(T container) {
    const Position where = places_.next();
    if (open_.size() == limits_.depth) {
      return stop(where, {Errc::limit, "json_too_deep"},
                  "nested deeper than " + std::to_string(limits_.depth) + " levels");
    }
    Node& node = slot();
    node = Node{where, std::move(container)};
    open_.push_back(&node);
    return true;
  }

  bool close() {
    places_.next();
    open_.pop_back();
    return true;
  }

  std::string_view text_;
  TokenPlaces places_;
  Problems& problems_;
  JsonLimits limits_;
  Node root_;
  // The containers not closed yet. Each is the last item of the one before, which therefore does
  // not grow, so the addresses stay valid.
  std::vector<Node*> open_;
  bool refused_ = false;
};

}  // namespace

std::optional<Node> parse_json(std::string_view text, Problems& problems,
                               const JsonLimits& limits) {
  if (text.size() > limits.bytes) {
    problems.add({1, 1}, {Errc::limit, "file_too_large"}, "",
                 "the text has " + std::to_string(text.size()) + " bytes, more than " +
                     std::to_string(limits.bytes));
    return std::nullopt;
  }
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    problems.add(TokenPlaces::place_of(text, zero), {Errc::invalid_value, "json_syntax"}, "",
                 "a zero byte in the text");
    return std::nullopt;
  }
  TreeBuilder builder(text, problems, limits);
  constexpr bool kWholeText = true;
  constexpr bool kIgnoreComments = true;
  const bool accepted =
      nlohmann::json::sax_parse(text.begin(), text.end(), &builder,
                                nlohmann::json::input_format_t::json, kWholeText, kIgnoreComments);
  if (!accepted || builder.refused()) return std::nullopt;
  return builder.take();
}

Value to_value(const Node& node) {
  if (const auto* items = node.get_if<Node::Array>()) {
    Value::Array array;
    array.reserve(items->size());
    for (const Node& item : *items) array.push_back(to_value(item));
    return array;
  }
  if (const auto* members = node.get_if<Node::Object>()) {
    Value::Object object;
    object.reserve(members->size());
    for (const Member& member : *members) object.emplace_back(member.key, to_value(member.value));
    return object;
  }
  if (const auto* flag = node.get_if<bool>()) return *flag;
  if (const auto* integer = node.get_if<std::int64_t>()) return *integer;
  if (const auto* integer = node.get_if<std::uint64_t>()) return *integer;
  if (const auto* number = node.get_if<double>()) return *number;
  if (const auto* text = node.get_if<std::string>()) return *text;
  return {};
}

std::string_view kind_of(const Node& node) {
  constexpr std::string_view kKinds[] = {"null",     "a boolean", "an integer", "a number",
                                         "a string", "an array",  "an object",  "an integer"};
  return kKinds[node.content.index()];
}

}  // namespace mauve::arch
