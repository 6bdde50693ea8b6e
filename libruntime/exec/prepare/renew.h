// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resources that are made anew under their names: of a newer build, or with another property of
/// shell or interface. Ports hold services of the old one, so all its users go over to the new one,
/// at a barrier, where it takes the state over (model/element/state_transfer.h).
#pragma once

#include "exec/system/system.h"

namespace mauve::exec {

/// Replaces each such edit of the change by its steps: the resource leaves, its replacement joins
/// with the same values and connections, and its users are connected anew. On an error too `change`
/// owns the elements that were made. Under System::model. [factory]
[[nodiscard]] Status put_as_replacements(const Architecture& architecture, Change& change);

}  // namespace mauve::exec
