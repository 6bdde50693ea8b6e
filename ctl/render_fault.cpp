// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "render.h"
#include "table.h"

namespace mauve::ctl {
namespace {

std::string state_in_words(const Fault& fault) {
  const std::string generation =
      fault.generation ? "generation " + std::to_string(*fault.generation) : std::string{};
  if (fault.state == "unknown") return "unknown, the change may still be carried out";
  if (fault.state == "safe") return "safe, outputs have their safe values";
  if (generation.empty()) return harmless(fault.state);
  if (fault.state == "rolled_back") return "rolled back (" + generation + " runs again)";
  return harmless(fault.state) + " (" + generation + " still running)";
}

}  // namespace

std::string render_fault(std::string_view command, const Fault& fault, Look look) {
  std::string text = painted("error:", Paint::red, look.colour) + " ";
  if (!command.empty()) text.append(command).append(": ");
  text += harmless(fault.message) + "\n";
  if (!fault.where.empty()) text += "  where  : " + harmless(fault.where) + "\n";
  text += "  state  : " + state_in_words(fault) + "\n";
  if (!fault.hint.empty()) text += "  hint   : " + harmless(fault.hint) + "\n";
  return text;
}

Json fault_json(const Fault& fault) {
  Json error = {{"code", fault.code},   {"name", fault.name},   {"message", fault.message},
                {"state", fault.state}, {"where", fault.where}, {"hint", fault.hint},
                {"exit", fault.exit},   {"generation", nullptr}};
  if (fault.generation) error["generation"] = *fault.generation;
  return {{"error", std::move(error)}};
}

}  // namespace mauve::ctl
