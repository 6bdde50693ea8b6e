// SPDX-License-Identifier: LGPL-3.0-or-later
/// The component of line.h and a core without state for it.
#include "line.h"

namespace {

class Main final : public line::Core {
  mauve::Stateless stateless{*this};
  void update() override { shell().out.write(1.0); }
};

}  // namespace

MAUVE_PLUGIN(plugin) {
  plugin.core<Main>("main");
  plugin.component<line::Shell, line::Fsm>("unit", "main");
}
