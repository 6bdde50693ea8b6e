// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/last_system.h"

#include <utility>

#include "arch/parse/parse.h"
#include "protocol/framing.h"

namespace mauve::daemon {

LastSystem last_system(const Generations& generations) {
  for (const auto& one : generations.list()) {
    const auto text = generations.text(one.number);
    arch::Problems ignored;
    const auto spec = text ? arch::parse(*text, ignored) : std::nullopt;
    if (!spec) {
      continue;
    }
    LastSystem last{one.number, spec->name, {}};
    for (const auto& component : spec->components) {
      if (!component.start) {
        last.stopped.insert(component.name);
      }
    }
    return last;
  }
  return {};
}

std::string name_in(const std::string& text) {
  arch::Problems ignored;
  const auto spec = arch::parse(text, ignored);
  return spec ? spec->name : std::string();
}

std::string text_with_stopped(const std::string& text, const Names& stopped) {
  auto architecture = protocol::parse_json(text);
  if (!architecture || !architecture->is_object() || !architecture->contains("components")) {
    return text;
  }
  for (auto& [name, component] : (*architecture)["components"].items()) {
    if (stopped.contains(name) && component.is_object()) {
      component["start"] = false;
    }
  }
  return protocol::to_line(*architecture);
}

}  // namespace mauve::daemon
