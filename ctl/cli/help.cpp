// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/help.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "base/name.h"
#include "cli/options.h"
#include "commands/actions.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

constexpr std::size_t kTitles = 24;  ///< columns of the names
constexpr std::size_t kNarrow = 60;  ///< narrower than this there is no room beside them

constexpr std::string_view kExamples =
    "Examples:\n"
    "  mauvectl status\n"
    "  mauvectl watch odometry.read\n"
    "  mauvectl set control.core.speed=0.3\n"
    "  mauvectl swap-core control guidance/finite_time\n";

/// A name, and its text beside it; below it where the name is long or the terminal narrow.
std::string entry(const std::string& name, std::string_view text, std::size_t width) {
  const std::size_t indent = width < kNarrow ? 6 : kTitles;
  std::string title = "  " + name;
  const std::size_t used = columns(title);
  title += used + 2 <= indent ? std::string(indent - used, ' ') : "\n" + std::string(indent, ' ');
  for (const char letter : wrapped(text, width - std::min(width, indent), 0)) {
    title += letter;
    if (letter == '\n') title.append(indent, ' ');
  }
  return title + "\n";
}

/// "-n, --lines NUMBER".
std::string option_name(const Argument& option) {
  std::string name(option.name);
  if (const auto comma = name.find(','); comma != std::string::npos) name.insert(comma + 1, " ");
  return option.flag ? name : name + " " + option.placeholder();
}

std::string options_part(std::span<const Argument> all, std::size_t width) {
  std::string text;
  for (const Argument& one : all) {
    if (one.is_option()) text += entry(option_name(one), one.text, width);
  }
  return text;
}

std::string exit_codes_part(std::size_t width) {
  std::string text = "Exit codes:\n";
  for (const ExitCode& one : exit_codes()) {
    text += entry(std::to_string(one.code), one.text, width);
  }
  return text;
}

std::string usage_of(const Command& command) {
  std::string text = "Usage: mauvectl " + std::string(command.name);
  for (const Argument& one : command.arguments) {
    if (one.is_option()) continue;
    const std::string name = std::string(one.name) + (one.many ? "..." : "");
    text += one.required ? " " + name : " [" + name + "]";
  }
  return text + " [OPTIONS]";
}

std::string arguments_part(const Command& command, std::size_t width) {
  std::string text;
  for (const Argument& one : command.arguments) {
    if (!one.is_option()) text += entry(std::string(one.name), one.text, width);
  }
  return text;
}

}  // namespace

std::string Argument::placeholder() const {
  struct Named {
    std::string_view option;
    std::string_view placeholder;
  };
  constexpr Named kNamed[] = {{"--set", "NAME=VALUE"}, {"--probation", "JOBS|off"},
                              {"--misses", "M/K"},     {"--since", "TIME"},
                              {"--grep", "TEXT"},      {"--reason", "TEXT"},
                              {"--socket", "PATH"},    {"--if-generation", "GENERATION"}};
  const auto named = std::ranges::find(kNamed, name, &Named::option);
  if (named != std::end(kNamed)) return std::string(named->placeholder);
  if (!choices.empty()) {
    std::string all(choices);
    std::ranges::replace(all, ' ', '|');
    return all;
  }
  switch (kind) {
    case Kind::component:
      return many ? "COMPONENT,..." : "COMPONENT";
    case Kind::address:
      return "ADDRESS";
    case Kind::file:
      return "FILE";
    case Kind::duration:
      return "DURATION";
    case Kind::number:
      return "NUMBER";
    default:
      return name == "--for" ? "CONDITION" : "VALUE";
  }
}

std::string help_text(std::size_t width) {
  std::string text = "Usage: mauvectl [OPTIONS] COMMAND [ARGUMENTS]\n\n";
  text += wrapped("mauvectl looks at a running mauved and changes what runs in it.", width, 0);
  text += "\n\nCommands:\n";
  for (const Command& one : commands()) {
    text += entry(std::string(one.name), std::string(one.text) + ".", width);
  }
  text += "\nOptions of every command:\n" + options_part(global_options(), width);
  text += entry("-h, --help", "print help", width) + entry("--version", "print the version", width);
  text += "\n" +
          wrapped("A DURATION is a number and a unit, such as 250us, 10ms, 5s or 2min.", width, 0);
  text += "\n\n" + std::string(kExamples) + "\n" + exit_codes_part(width) + "\n";
  text += wrapped(
      "'mauvectl help COMMAND' explains one command. Texts for people may change between "
      "releases; JSON only grows.",
      width, 0);
  return text + "\n";
}

std::string help_text(const Command& command, std::size_t width) {
  std::string text = wrapped(usage_of(command), width, 2) + "\n\n";
  text += wrapped(std::string(command.text) + ".", width, 0) + "\n";
  if (const auto part = arguments_part(command, width); !part.empty()) {
    text += "\nArguments:\n" + part;
  }
  if (const auto part = options_part(command.arguments, width); !part.empty()) {
    text += "\nOptions:\n" + part;
  }
  if (command.changes) {
    text += "\n" +
            wrapped(
                "It also takes --if-generation GENERATION and --reason TEXT, for a use that "
                "changes the system.",
                width, 0) +
            "\n";
  }
  return text + "\n" + wrapped("Example: " + std::string(command.example), width, 2) + "\n";
}

int run_help(Session& session) {
  constexpr std::size_t kPiped = 80;
  const std::size_t width = session.screen.width == 0 ? kPiped : session.screen.width;
  const std::string name = session.arguments.one("COMMAND");
  if (name.empty()) {
    session.print(Json{{"help", help_text(width)}}, help_text(width));
    return 0;
  }
  const Command* command = find_command(name);
  if (command == nullptr) {
    std::vector<std::string> names;
    for (const Command& one : commands()) names.emplace_back(one.name);
    std::string hint = did_you_mean(name, names, "'");
    if (hint.empty()) hint = "mauvectl help lists all commands";
    return session.fail(protocol::wrong_use(
        "usage_unknown_command", "there is no command '" + name + "'", {}, std::move(hint)));
  }
  session.print(Json{{"help", help_text(*command, width)}}, help_text(*command, width));
  return 0;
}

}  // namespace mauve::ctl
