// SPDX-License-Identifier: LGPL-3.0-or-later
/// The steps of one transaction against the architecture that they would change.
#pragma once

#include <string>
#include <string_view>

#include "arch/parse/spec.h"

namespace mauve {
class Architecture;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

struct Built {
  const Spec& spec;
  const Architecture& architecture;  ///< without the elements that were refused
  const plugin::Catalog& catalog;
};

/// Is it in the file, but refused and not in the architecture?
[[nodiscard]] bool was_refused(const Spec& spec, const Architecture& architecture,
                               std::string_view element);

/// Reports every step that could not be applied to the system as the file describes it, and steps
/// that contradict each other. `at` is the address of the transaction. [control]
void check_steps(const TransactionSpec& transaction, const std::string& at, const Built& built,
                 Problems& problems);

}  // namespace mauve::arch
