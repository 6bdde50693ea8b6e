// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/read.h"

#include <algorithm>
#include <utility>

#include "base/duration.h"
#include "base/name.h"
#include "base/size.h"

namespace mauve::arch {
namespace {

// A key or word of the file in a message; it may be long or hold anything.
std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 64;
  if (text.size() <= kLongest) return '"' + std::string(text) + '"';
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;
  return '"' + std::string(text.substr(0, end)) + "...\"";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

const Field* find_field(std::initializer_list<Field> fields, std::string_view key) {
  const auto* found =
      std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == key; });
  return found == fields.end() ? nullptr : found;
}

}  // namespace

void Source::refuse(std::string message, std::string hint, Reason reason) const {
  problems.add(node.where, reason, at, std::move(message), std::move(hint));
}

void Source::refuse_kind(std::string_view wanted, std::string hint) const {
  std::string message = "expected ";
  message.append(wanted).append(", got ").append(kind_of(node));
  refuse(std::move(message), std::move(hint));
}

Source Source::inner(const Node& value, std::string_view name) const {
  std::string address = at;
  if (!address.empty()) address += '.';
  return {value, address.append(name), problems};
}

std::string nearest_hint(std::string_view wanted, const std::vector<std::string>& known) {
  if (std::string hint = did_you_mean(wanted, known, "\""); !hint.empty()) return hint;
  constexpr std::size_t kMostListed = 16;
  if (known.empty() || known.size() > kMostListed) return {};
  return "there is: " + joined(known);
}

const Node::Object* read_object(const Source& source, std::initializer_list<Field> fields) {
  const auto* members = source.node.get_if<Node::Object>();
  if (members == nullptr) {
    source.refuse_kind("an object");
    return nullptr;
  }
  std::vector<std::string> known;
  for (const Field& field : fields) known.emplace_back(field.key);
  for (const Member& member : *members) {
    if (const Field* field = find_field(fields, member.key)) {
      field->read(source.inner(member.value, member.key));
    } else {
      source.problems.add(member.where, {Errc::unknown_name, "file_key_unknown"}, source.at,
                          "unknown key " + in_quotes(member.key), nearest_hint(member.key, known));
    }
  }
  return members;
}

void require_key(const Source& source, const Node::Object& members, std::string_view key,
                 std::string_view example) {
  const bool there = std::any_of(members.begin(), members.end(),
                                 [&](const Member& member) { return member.key == key; });
  if (there) return;
  source.refuse("\"" + std::string(key) + "\" is missing", "write " + std::string(example),
                {Errc::invalid_value, "file_key_missing"});
}

void read_members(const Source& source,
                  const std::function<void(const Member&, const Source&)>& read) {
  const auto* members = source.node.get_if<Node::Object>();
  if (members == nullptr) return source.refuse_kind("an object");
  for (const Member& member : *members) read(member, source.inner(member.value, member.key));
}

void read_items(const Source& source, const std::function<void(const Source&)>& read) {
  const auto* items = source.node.get_if<Node::Array>();
  if (items == nullptr) return source.refuse_kind("an array");
  for (const Node& item : *items) read({item, source.at, source.problems});
}

std::optional<std::string> read_text(const Source& source) {
  if (const auto* text = source.node.get_if<std::string>()) return *text;
  source.refuse_kind("a string");
  return std::nullopt;
}

std::optional<bool> read_flag(const Source& source) {
  if (const auto* flag = source.node.get_if<bool>()) return *flag;
  source.refuse_kind("true or false");
  return std::nullopt;
}

std::optional<std::int64_t> read_integer(const Source& source, std::int64_t low,
                                         std::int64_t high) {
  const auto* integer = source.node.get_if<std::int64_t>();
  if (kind_of(source.node) != "an integer") {
    source.refuse_kind("an integer");
    return std::nullopt;
  }
  if (integer == nullptr || *integer < low || *integer > high) {
    source.refuse(to_string(to_value(source.node)) + " is not from " + std::to_string(low) +
                  " to " + std::to_string(high));
    return std::nullopt;
  }
  return *integer;
}

std::optional<Duration> read_duration(const Source& source) {
  const auto* text = source.node.get_if<std::string>();
  if (text == nullptr) {
    source.refuse_kind("a duration", "write a number and a unit as text, such as \"10ms\"");
    return std::nullopt;
  }
  const Result<Duration> duration = parse_duration(*text);
  if (duration) return *duration;
  source.refuse(duration.error().message, duration.error().hint, reason_of(duration.error()));
  return std::nullopt;
}

std::optional<Duration> read_positive(const Source& source) {
  auto duration = read_duration(source);
  if (duration != Duration{0}) return duration;
  source.refuse("must be over 0");
  return std::nullopt;
}

std::optional<std::size_t> read_size(const Source& source, std::size_t low, std::size_t high) {
  const auto* text = source.node.get_if<std::string>();
  if (text == nullptr) {
    source.refuse_kind("a size", "write a number and a unit as text, such as \"64KiB\"");
    return std::nullopt;
  }
  const Result<std::uint64_t> size = parse_size(*text);
  if (!size) {
    source.refuse(size.error().message, size.error().hint, reason_of(size.error()));
    return std::nullopt;
  }
  if (*size < low || *size > high) {
    source.refuse(in_quotes(*text) + " is not from " + format_size(low) + " to " +
                  format_size(high));
    return std::nullopt;
  }
  return *size;
}

std::optional<std::size_t> read_word(const Source& source, const std::vector<std::string>& words) {
  const std::optional<std::string> text = read_text(source);
  if (!text) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), *text);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  source.refuse(in_quotes(*text) + " is not one of " + joined(words), nearest_hint(*text, words));
  return std::nullopt;
}

}  // namespace mauve::arch
