// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the steps of a transaction to a Change of the system as it is now.
#pragma once

#include "mauve/host/change.h"
#include "rules/supervision.h"

namespace mauve {
class Architecture;
class Deployer;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// The steps merged into one edit a component. A step without effect is left out, so that a
/// transaction can be applied twice: a port connected as wanted, a core in force, a component that
/// runs or stands. The result may be empty. Refused: a name that does not exist (any more).
/// [control]
[[nodiscard]] Result<Change> change_of(const rules::Steps& steps, const Architecture& architecture,
                                       const Deployer& deployer, const plugin::Catalog& catalog);

}  // namespace mauve::arch
