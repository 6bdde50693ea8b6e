// SPDX-License-Identifier: LGPL-3.0-or-later
#include "homing.h"

MAUVE_PLUGIN(plugin) { plugin.core<homing::Straight>("straight"); }
