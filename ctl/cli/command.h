// SPDX-License-Identifier: LGPL-3.0-or-later
/// The commands of mauvectl: one row each, from which parser, help, completion and manual are made.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mauve::ctl {

class Session;

/// The kind of an argument decides the names that completion offers for it, and its placeholder in
/// help.
enum class Kind {
  none,
  component,
  core,
  port,
  service,
  address,
  assignment,
  plugin,
  rule,
  explained,
  file,
  category,
  command,
  method,      ///< of the wire
  available,   ///< a plugin that is not loaded
  setting,     ///< KEY= of a property of a core
  generation,  ///< a saved one
  recording,   ///< a flight recording
  duration,
  number
};

struct Argument {
  std::string_view name;  ///< "COMPONENT", or "--set" for an option
  std::string_view text;
  Kind kind = Kind::none;
  bool required = false;
  bool many = false;
  bool flag = false;              ///< an option without value
  std::string_view choices = {};  ///< the words that it takes, a blank between them
  bool others = false;            ///< takes more than these

  [[nodiscard]] bool is_option() const { return name.starts_with('-'); }
  [[nodiscard]] std::vector<std::string> words() const;
  /// The word for the value of an option in help and manual: "DURATION", "FILE", "cut|barrier".
  [[nodiscard]] std::string placeholder() const;
};

struct Command {
  std::string_view name;
  std::string_view text;  ///< one sentence without its full stop
  std::string_view example;
  std::span<const Argument> arguments;
  bool changes = false;  ///< takes --if-generation and --reason
  int (*run)(Session&) = nullptr;
  std::string_view method = {};  ///< of run_answer(): the method whose answer is printed
};

[[nodiscard]] std::span<const Command> commands();
[[nodiscard]] const Command* find_command(std::string_view name);

/// A category that `list` can list, and the method of the wire for it.
struct Category {
  std::string_view name;
  std::string_view method;
};
[[nodiscard]] std::span<const Category> categories();

/// The options before or after the command.
struct Globals {
  std::string socket;
  bool json = false;
  std::string colour = "auto";
  std::string timeout;  ///< as written; empty: the default of the command
  std::string wait;     ///< as written, empty: a daemon that is not there is an error at once
  std::optional<std::uint64_t> if_generation;
  std::string reason;
};

/// The values of the arguments that were given, by the names in the table.
class Arguments {
 public:
  void add(std::string_view name, std::string value) {
    values_[std::string(name)].push_back(std::move(value));
  }
  [[nodiscard]] bool has(std::string_view name) const { return values_.contains(name); }
  /// The first, or empty.
  [[nodiscard]] std::string one(std::string_view name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? std::string{} : found->second.front();
  }
  [[nodiscard]] std::vector<std::string> all(std::string_view name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? std::vector<std::string>{} : found->second;
  }

 private:
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

/// The words in which arguments.h is written. They stand for an argument that must be given, an
/// optional one, and both with several values; an option without value; a choice of words.
namespace argument_table {

constexpr Argument one(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind, true};
}
constexpr Argument maybe(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind};
}
constexpr Argument some(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind, true, true};
}
constexpr Argument any(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind, false, true};
}
constexpr Argument flag(std::string_view name, std::string_view text) {
  return {name, text, Kind::none, false, false, true};
}

constexpr Argument choice(std::string_view name, std::string_view text, std::string_view choices) {
  return {name, text, Kind::none, false, false, false, choices};
}
constexpr Argument one_of(std::string_view name, std::string_view text, std::string_view choices) {
  return {name, text, Kind::none, true, false, false, choices};
}
/// Accepts this word, besides the other values of the argument.
constexpr Argument also(std::string_view word, Argument argument) {
  argument.choices = word;
  argument.others = true;
  return argument;
}

}  // namespace argument_table

}  // namespace mauve::ctl
