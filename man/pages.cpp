// SPDX-License-Identifier: LGPL-3.0-or-later
#include "pages.h"

#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

#include "cli/command.h"
#include "cli/options.h"
#include "daemon/options.h"
#include "protocol/methods_text.h"
#include "render/words.h"
#include "roff.h"
#include "schema.h"

namespace mauve::man {
namespace {

std::string argument_synopsis(const ctl::Argument& argument) {
  std::string text = bold(argument.name);
  if (argument.is_option()) {
    const auto comma = argument.name.find(',');
    if (comma != std::string_view::npos) {
      text = bold(argument.name.substr(0, comma)) + ", " + bold(argument.name.substr(comma + 1));
    }
    if (!argument.flag) text += " " + italic(argument.placeholder());
    return text;
  }
  text = italic(argument.name) + (argument.many ? "..." : "");
  return argument.required ? text : "[" + text + "]";
}

std::string options_of(std::span<const ctl::Argument> arguments) {
  std::string text;
  for (const ctl::Argument& argument : arguments) {
    text += item(argument_synopsis(argument), plain(argument.text));
  }
  return text;
}

std::optional<std::string> text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream.is_open()) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(stream), {}};
}

/// The part that a line of a template stands for; "" is none.
std::string part(const std::string& name, const std::string& argument, const std::string& text) {
  if (name == "commands") return commands();
  if (name == "global-options") return global_options();
  if (name == "exit-codes") return exit_codes();
  if (name == "examples") return examples();
  if (name == "daemon-options") return daemon_options();
  if (name == "methods") return methods();
  if (name == "methods-markdown") return protocol::methods_in_markdown();
  if (name == "keys") return keys(text);
  if (name == "file") return verbatim(text);
  return name == "section" ? roff(section(text, argument)) : "";
}

Error refused(const std::string& line, const std::string& why) {
  return refuse(Errc::invalid_value, line, why, "man/README.md lists what may stand here");
}

}  // namespace

std::string commands() {
  std::string text;
  for (const ctl::Command& command : ctl::commands()) {
    std::string synopsis = bold(command.name);
    for (const ctl::Argument& argument : command.arguments) {
      if (!argument.is_option()) synopsis += " " + argument_synopsis(argument);
    }
    text += ".SS " + synopsis + "\n" + plain(command.text) + ".\n";
    text += options_of(command.arguments);
    if (command.changes)
      text +=
          ".PP\nAlso takes \\fB\\-\\-if\\-generation\\fP and \\fB\\-\\-reason\\fP, for a use that "
          "changes the system.\n";
    text += ".PP\nExample: " + bold(command.example) + "\n";
  }
  return text;
}

std::string global_options() { return options_of(ctl::global_options()); }

std::string exit_codes() {
  std::string text;
  for (const ctl::ExitCode& code : ctl::exit_codes()) {
    text += item(bold(std::to_string(code.code)), plain(code.text));
  }
  return text;
}

std::string examples() {
  std::string text;
  for (const ctl::Command& command : ctl::commands()) {
    text += item(bold(command.example), plain(command.text));
  }
  return text;
}

std::string daemon_options() {
  std::string text;
  for (const daemon::OptionText& option : daemon::option_texts()) {
    const bool argument = !option.name.starts_with('-');
    std::string tag = argument ? "" : bold(option.name) + " ";
    if (!option.value.empty()) tag += italic(option.value);
    std::string about = plain(option.text) + ".";
    if (!option.otherwise.empty()) about += " Default: " + bold(option.otherwise) + ".";
    text += item(tag, about);
  }
  return text;
}

std::string methods() { return roff(protocol::methods_in_markdown()); }

std::string keys(std::string_view schema) { return schema_keys(schema); }

Result<std::string> page(std::string_view text, const std::filesystem::path& sources) {
  std::istringstream lines{std::string(text)};
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('@')) {
      result += line + "\n";
      continue;
    }
    std::istringstream words(line.substr(1));
    std::string name;
    std::string file;
    words >> name >> file;
    std::string argument{std::istreambuf_iterator<char>(words >> std::ws), {}};
    const auto content = file.empty() ? std::string{} : text_of(sources / file);
    if (!content) return refused(line, "the file cannot be read");
    const std::string its = part(name, argument, *content);
    if (its.empty()) return refused(line, "stands for nothing");
    result += its;
  }
  return result;
}

}  // namespace mauve::man
