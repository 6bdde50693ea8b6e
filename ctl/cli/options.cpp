// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/options.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <utility>

#include <CLI/CLI.hpp>

#include "base/duration.h"
#include "base/name.h"
#include "cli/help.h"
#include "cli/session.h"
#include "protocol/socket_path.h"

namespace mauve::ctl {
namespace {

using protocol::wrong_use;

constexpr Argument kGlobals[] = {
    {"--socket", "of the daemon; else MAUVE_SOCKET, else the usual one", Kind::file},
    {"--json", "one line of JSON on stdout, errors included", Kind::none, false, false, true},
    {"--timeout", "how long to wait for an answer, such as 5s", Kind::duration},
    {"--wait", "try again for so long while mauved does not answer, such as 5s", Kind::duration},
    {"--if-generation", "change only if this generation is running", Kind::none},
    {"--reason", "why you change it, for the log", Kind::none},
    {"--color", "auto, always or never", Kind::none, false, false, false, "auto always never"},
};

constexpr ExitCode kExitCodes[] = {
    {0, "done", "Done."},
    {1, "refused",
     "Refused, nothing changed. Of diff: something differs. Of check: the file has errors. Of "
     "check-trace: the trace breaks a rule. Of doctor: something fails."},
    {2, "wrong use", "Wrong use."},
    {3, "condition false", "Of wait: the condition did not hold in time."},
    {4, "no such object", "No such object."},
    {5, "permission", "Not permitted."},
    {6, "conflict", "Conflict: another generation, locked, busy."},
    {7, "no daemon", "No daemon, or it went away."},
    {8, "timed out", "Timed out, outcome unknown."},
    {9, "done partly", "Done partly: mauvectl status shows which components did not obey."},
};

using Values = std::map<std::string_view, std::vector<std::string>>;

// The library takes no '=' in the name of an argument.
constexpr std::string_view kAddressValue = "ADDRESS=VALUE";
constexpr std::string_view kAssignment = "ASSIGNMENT";

std::string cli_name(const Argument& argument) {
  if (argument.is_option()) return std::string(argument.name);
  return std::string(argument.name == kAddressValue ? kAssignment : argument.name);
}

void add_argument(CLI::App& app, const Argument& argument, Values& values) {
  const std::string name = cli_name(argument);
  const std::string text(argument.text);
  if (argument.flag) {
    app.add_flag_callback(
        name, [&values, key = argument.name] { values[key] = {"true"}; }, text);
    return;
  }
  CLI::Option* option = app.add_option(name, values[argument.name], text);
  option->required(argument.required);
  const bool takes_many = argument.many && !argument.is_option();
  if (!takes_many) option->expected(1)->allow_extra_args(false);
  if (argument.many) option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::string near(std::string_view wanted, const std::vector<std::string>& known,
                 const std::string& otherwise) {
  std::string hint = did_you_mean(wanted, known, "'");
  return hint.empty() ? otherwise : hint;
}

/// The dashes, which all options have, make none of them nearer.
std::string near_option(std::string_view wanted, std::vector<std::string> known,
                        const std::string& otherwise) {
  const auto bare = [](std::string_view name) {
    return name.substr(std::min(name.size(), name.find_first_not_of('-')));
  };
  for (std::string& name : known) name = bare(name);
  const std::string nearest = nearest_name(bare(wanted), known);
  return nearest.empty() ? otherwise : "did you mean '--" + nearest + "'?";
}

std::vector<std::string> option_names(const Command* command) {
  std::vector<std::string> names{"--help", "--version"};
  const auto add = [&](const Argument& argument) {
    if (!argument.is_option()) return;
    names.emplace_back(argument.name.substr(argument.name.rfind(',') + 1));
  };
  std::for_each(std::begin(kGlobals), std::end(kGlobals), add);
  if (command != nullptr) {
    std::for_each(command->arguments.begin(), command->arguments.end(), add);
  }
  return names;
}

/// "'status' or 'stats'": the commands that `word` begins, first those that change nothing; empty
/// when there are more than four.
std::string commands_begun_by(std::string_view word) {
  std::string text;
  std::size_t count = 0;
  for (const bool changes : {false, true}) {
    for (const Command& one : commands()) {
      if (word.size() < 2 || one.changes != changes || !one.name.starts_with(word)) continue;
      text += (count++ == 0 ? "'" : " or '") + std::string(one.name) + "'";
    }
  }
  return count > 4 ? std::string{} : text;
}

/// The hint for an unknown command. A command that only looks goes before an equally near one.
std::string near_command(std::string_view word, const std::string& help) {
  if (const auto begun = commands_begun_by(word); !begun.empty()) {
    return "did you mean " + begun + "?";
  }
  std::vector<std::string> names;
  for (const bool changes : {false, true}) {
    for (const Command& one : commands()) {
      if (one.changes == changes) names.emplace_back(one.name);
    }
  }
  return near(word, names, help);
}

Fault unexpected(const std::string& word, const Command* command) {
  const std::string help =
      "mauvectl " + (command != nullptr ? std::string(command->name) + " " : "") + "--help";
  if (word.starts_with('-')) {
    return wrong_use("usage_unknown_option", "unknown option '" + word + "'", {},
                     near_option(word, option_names(command), help));
  }
  if (command != nullptr) {
    return wrong_use("usage_too_many_arguments",
                     "'" + word + "' is one argument too many for " + std::string(command->name),
                     {}, "example: " + std::string(command->example));
  }
  return wrong_use("usage_unknown_command", "unknown command '" + word + "'", {},
                   near_command(word, help));
}

/// The parser of the library, filled from the table, and where its values go.
struct Parser {
  CLI::App app{"Looks at mauved and changes what runs in it.", "mauvectl"};
  Values global_values;
  std::map<std::string_view, Values> values;

  explicit Parser(const std::vector<std::string>& words) {
    app.allow_extras();
    app.require_subcommand(0, 1);
    app.set_version_flag("--version", std::string("mauvectl ") + MAUVE_VERSION);
    for (const Argument& argument : kGlobals) add_argument(app, argument, global_values);
    // Only commands that the line names: all of them would take a millisecond.
    for (const Command& command : commands()) {
      if (std::ranges::find(words, command.name) != words.end()) add_command(command);
    }
  }

  void add_command(const Command& command) {
    CLI::App* sub = app.add_subcommand(std::string(command.name), std::string(command.text));
    sub->fallthrough();
    for (const Argument& argument : command.arguments) {
      add_argument(*sub, argument, values[command.name]);
    }
  }

  [[nodiscard]] const Command* chosen() const {
    const auto subcommands = app.get_subcommands();
    return subcommands.empty() ? nullptr : find_command(subcommands.front()->get_name());
  }

  [[nodiscard]] std::string global(std::string_view name) const {
    const auto found = global_values.find(name);
    return found == global_values.end() || found->second.empty() ? std::string{}
                                                                 : found->second.back();
  }
};

constexpr std::string_view kDurations[] = {"--budget", "--max-age", "--confirm-within"};

/// A value that the daemon would refuse in every state is a wrong use of the command.
std::optional<Fault> check_value(const Argument& argument, const std::string& value) {
  const std::string_view name = argument.name;
  if (std::ranges::find(kDurations, name) != std::end(kDurations)) {
    const auto time = parse_duration(value);
    if (!time)
      return wrong_use("usage_not_a_time", std::string(name) + ": " + time.error().message, {},
                       time.error().hint);
  }
  const auto words = argument.words();
  const bool known = words.empty() || std::ranges::find(words, value) != words.end();
  if (known || argument.others) return std::nullopt;
  return wrong_use("usage_unknown_word", "'" + value + "' is no value of " + std::string(name), {},
                   near(value, words, "one of: " + std::string(argument.choices)));
}

std::optional<Fault> read_globals(const Parser& parser, const Command& command, Globals& globals) {
  for (const Argument& argument : kGlobals) {
    const std::string value = parser.global(argument.name);
    if (value.empty()) continue;
    if (auto fault = check_value(argument, value)) return fault;
  }
  globals.socket = parser.global("--socket");
  if (globals.socket.empty()) globals.socket = protocol::default_socket_path();
  globals.json = !parser.global("--json").empty();
  globals.reason = parser.global("--reason");
  globals.timeout = parser.global("--timeout");
  if (!globals.timeout.empty() && !timeout_of(globals.timeout)) {
    return wrong_use("usage_not_a_time", "'" + globals.timeout + "' is not a time to wait", {},
                     "example: --timeout 5s");
  }
  globals.wait = parser.global("--wait");
  if (!globals.wait.empty() && !timeout_of(globals.wait)) {
    return wrong_use("usage_not_a_time", "'" + globals.wait + "' is not a time to wait", {},
                     "example: --wait 5s");
  }
  if (const auto colour = parser.global("--color"); !colour.empty()) globals.colour = colour;
  const std::string generation = parser.global("--if-generation");
  if (!command.changes && (!generation.empty() || !globals.reason.empty())) {
    return wrong_use("usage_changes_nothing",
                     "--if-generation and --reason are for commands that change something", {},
                     std::string(command.name) + " changes nothing");
  }
  if (generation.empty()) return std::nullopt;
  std::uint64_t number = 0;
  const char* end = generation.data() + generation.size();
  const auto read = std::from_chars(generation.data(), end, number);
  if (read.ec != std::errc{} || read.ptr != end) {
    return wrong_use("usage_not_a_generation", "'" + generation + "' is not a generation", {},
                     "mauvectl status shows it");
  }
  globals.if_generation = number;
  return std::nullopt;
}

/// The values that were given, checked; the fault of the first that nothing takes.
std::optional<Fault> take_values(std::span<const Argument> arguments, const Values& values,
                                 Arguments& into) {
  for (const Argument& argument : arguments) {
    const auto given = values.find(argument.name);
    if (given == values.end()) continue;
    for (const std::string& value : given->second) {
      if (auto fault = check_value(argument, value)) return fault;
      into.add(argument.name, value);
    }
  }
  return std::nullopt;
}

std::variant<Invocation, Text, Misuse> invocation_of(const Parser& parser) {
  const Command* command = parser.chosen();
  const bool json = !parser.global("--json").empty();
  if (const auto extra = parser.app.remaining(true); !extra.empty()) {
    return Misuse{unexpected(extra.front(), command), json};
  }
  if (command == nullptr)
    return Misuse{wrong_use("usage_missing_argument", "no command given", {}, "mauvectl --help"),
                  json};
  Invocation invocation;
  invocation.command = command;
  const Values& values = parser.values.at(command->name);
  if (auto fault = take_values(command->arguments, values, invocation.arguments)) {
    return Misuse{std::move(*fault), json};
  }
  if (auto fault = read_globals(parser, *command, invocation.globals)) {
    return Misuse{std::move(*fault), json};
  }
  return invocation;
}

}  // namespace

std::variant<Invocation, Text, Misuse> parse_options(const std::vector<std::string>& words,
                                                     std::size_t width) {
  Parser parser(words);
  for (const Command& command : commands()) parser.values.try_emplace(command.name);
  // The door of the library's exceptions: they also carry the calls for help.
  try {
    parser.app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    const Command* command = parser.chosen();
    return Text{command == nullptr ? help_text(width) : help_text(*command, width)};
  } catch (const CLI::CallForVersion& version) {
    return Text{std::string(version.what()) + "\n"};
  } catch (const CLI::ParseError& error) {
    const bool json = std::find(words.begin(), words.end(), "--json") != words.end();
    const Command* command = parser.chosen();
    std::string message = error.what();
    if (const auto at = message.find(kAssignment); at != std::string::npos) {
      message.replace(at, kAssignment.size(), kAddressValue);
    }
    return Misuse{wrong_use("usage_missing_argument", std::move(message), {},
                            command != nullptr ? "example: " + std::string(command->example)
                                               : "mauvectl --help"),
                  json};
  }
  return invocation_of(parser);
}

std::span<const Argument> global_options() { return kGlobals; }

std::span<const ExitCode> exit_codes() { return kExitCodes; }

}  // namespace mauve::ctl
