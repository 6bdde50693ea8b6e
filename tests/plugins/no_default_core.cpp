// SPDX-License-Identifier: LGPL-3.0-or-later
/// Its component type names a default core that it does not have.
#include "number.h"

MAUVE_PLUGIN(plugin) { plugin.component<zoo::NumberShell, zoo::NumberFsm>("counter", "nubmer"); }
