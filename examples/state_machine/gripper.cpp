// SPDX-License-Identifier: LGPL-3.0-or-later
#include "gripper.h"

MAUVE_PLUGIN(plugin) { plugin.component<gripper::Shell, gripper::Core, gripper::Fsm>("gripper"); }
