// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components that command a device which nothing makes safe.
#pragma once

#include <vector>

#include "model/component/wiring.h"

namespace mauve {

class Architecture;

namespace arch {

/// A sentence on each component that opens a device, reads values of others, and declares no
/// mauve::Guarded: it hands commands on, and the device goes on with the last one. A device is
/// that of mauve::device_of(). [control] or [factory]
[[nodiscard]] std::vector<Wiring::Note> unguarded_devices(const Architecture& architecture);

}  // namespace arch
}  // namespace mauve
