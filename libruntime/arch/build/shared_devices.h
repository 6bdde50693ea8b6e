// SPDX-License-Identifier: LGPL-3.0-or-later
/// Two components that name one device.
#pragma once

#include <vector>

#include "model/component/wiring.h"

namespace mauve {

class Architecture;

namespace arch {

/// A sentence on each component whose core opens a device that the core of another component opens
/// too. A device is a property `device` for paths in /dev/ (Limits::within). A resource may share
/// the device of a component, as a brake does. [control] or [factory]
[[nodiscard]] std::vector<Wiring::Note> shared_devices(const Architecture& architecture);

}  // namespace arch
}  // namespace mauve
