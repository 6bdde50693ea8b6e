// SPDX-License-Identifier: LGPL-3.0-or-later
/// The tables in which the dynamic linker looks a symbol up.
#pragma once

#include "mauve/result.h"
#include "plugin/elf/elf_file.h"

namespace mauve::plugin {

/// Refused: a table of hashes, symbols or names that a lookup would leave. The dynamic linker
/// follows them without a look at their ends. The bytes behind them differ from process to process,
/// so a trial elsewhere proves nothing. [any]
Status check_lookup(const ElfFile& file);

}  // namespace mauve::plugin
