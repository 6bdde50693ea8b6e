// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <string>
#include <string_view>

#include "protocol/methods.h"
#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

std::string state_in_words(const Fault& fault) {
  const std::string generation =
      fault.generation ? "generation " + std::to_string(*fault.generation) : std::string{};
  if (fault.state == "unknown") return "unknown, the change may still be carried out";
  if (fault.state == "safe") return "safe, outputs have their safe values";
  const bool asked = fault.code != protocol::kUnreachable && fault.id != "socket_not_permitted";
  if (!asked && fault.state == "unchanged") return "not known; mauvectl changed nothing";
  if (generation.empty()) return harmless(fault.state);
  if (fault.state == "rolled_back") return "rolled back (" + generation + " runs again)";
  return harmless(fault.state) + " (" + generation + " still running)";
}

/// Most messages are about the thing at `where`, and begin with their verb.
bool lacks_subject(std::string_view message) {
  constexpr std::string_view kVerbs[] = {"is ",    "has ",       "had ",         "was ",
                                         "did ",   "does ",      "may ",         "must ",
                                         "needs ", "cannot be ", "cannot have ", "declares "};
  return std::ranges::any_of(kVerbs, [&](auto verb) { return message.starts_with(verb); });
}

/// The method of the protocol, which its user did not type.
bool is_about_the_command(const Fault& fault) {
  return protocol::find_method(fault.where) != nullptr;
}

/// "set arm.gain: expected a number"; "set: arm did not end its job"; "set: the command needs role
/// operator".
std::string sentence_of(std::string_view command, const Fault& fault) {
  std::string subject;
  if (!fault.where.empty() && lacks_subject(fault.message)) {
    subject = is_about_the_command(fault) ? "the command " : fault.where + " ";
    command = command.substr(0, command.find(' '));
  }
  return (command.empty() ? "" : std::string(command) + ": ") + harmless(subject + fault.message);
}

}  // namespace

std::string render_fault(std::string_view command, const Fault& fault, Look look) {
  const std::string message = sentence_of(command, fault);
  const auto part = [&](const char* name, const std::string& content) {
    return content.empty() ? "" : wrapped(name + content, look.width, 11) + "\n";
  };
  // A refusal by a hook of a plugin has no entry of its own: its kind explains it.
  const std::string& entry = fault.id.empty() ? fault.name : fault.id;
  constexpr std::string_view kError = "error:";
  const std::string first = wrapped(std::string(kError) + " " + message, look.width, 2);
  return painted(kError, Paint::red, look.colour) + first.substr(kError.size()) + "\n" +
         part("  where  : ", is_about_the_command(fault) ? "" : harmless(fault.where)) +
         part("  state  : ", state_in_words(fault)) + part("  hint   : ", harmless(fault.hint)) +
         part("  explain: ", entry.empty() ? "" : "mauvectl explain " + harmless(entry));
}

Json fault_json(const Fault& fault) {
  Json error = {{"code", fault.code},   {"name", fault.name},   {"message", fault.message},
                {"state", fault.state}, {"where", fault.where}, {"hint", fault.hint},
                {"exit", fault.exit},   {"generation", nullptr}};
  if (!fault.id.empty()) error["id"] = fault.id;
  if (fault.generation) error["generation"] = *fault.generation;
  if (!fault.errors.is_null()) error["errors"] = fault.errors;
  return {{"error", std::move(error)}};
}

}  // namespace mauve::ctl
