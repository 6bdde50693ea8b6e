// SPDX-License-Identifier: LGPL-3.0-or-later
/// Deployment: privileges, threads, T0.
#pragma once

#include <mauve/result.h>

namespace mauve::exec {

class System;

/// deploy(): privileges, threads, T0.
Status bring_up(System& system);

}  // namespace mauve::exec
