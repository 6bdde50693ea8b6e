// SPDX-License-Identifier: LGPL-3.0-or-later
#include "drive.h"

#include <algorithm>

namespace energy {

void Drive::update() {
  shell().speed.write(std::clamp(shell().wish.read(), -limit.get(), limit.get()));
}

}  // namespace energy
