// SPDX-License-Identifier: LGPL-3.0-or-later
/// The state machine of a component, and its pictures (the paper's Fig. 2). Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/words.h"

namespace mauve::ctl {

struct Machine {
  struct Transition {
    std::size_t to = 0;
    std::string mark;  ///< as mark_of_transition() gives it
  };
  struct State {
    std::string name;
    bool waits = false;  ///< a synchronization state
    std::string wait;    ///< how long, in words
    std::vector<Transition> transitions;
  };

  std::string component;
  std::string type;
  std::vector<State> states;
  std::size_t initial = 0;
  std::optional<std::size_t> current;
};

/// Of the answer to object.get for a component; no states when it has no machine.
[[nodiscard]] Machine machine_of(const Json& object);

[[nodiscard]] std::string machine_dot(const Machine& machine);
[[nodiscard]] std::string machine_mermaid(const Machine& machine);
[[nodiscard]] std::string machine_svg(const Machine& machine);

}  // namespace mauve::ctl
