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

/// Does "lost" of the file permit this name, although the architecture lacks it?
[[nodiscard]] bool is_lost(const Spec& spec, std::string_view name);

/// The name for which this step cannot be applied to the architecture: its subject, or its service
/// or core. Empty: it can be, or it sets a property of a core that the same steps put in place,
/// which only a core that is made would tell. [control]
[[nodiscard]] std::string name_lost_by(const rules::Step& step, const rules::Steps& steps,
                                       const Architecture& architecture,
                                       const plugin::Catalog& catalog);

/// Reports every step that could not be applied to the system as the file describes it, and steps
/// that contradict each other. `at` is the address of the transaction. [control]
void check_steps(const TransactionSpec& transaction, const std::string& at, const Built& built,
                 Problems& problems);

}  // namespace mauve::arch
