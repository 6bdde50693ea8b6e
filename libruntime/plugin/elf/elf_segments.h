// SPDX-License-Identifier: LGPL-3.0-or-later
/// The places in memory that a plugin asks for.
#pragma once

#include "mauve/result.h"
#include "plugin/elf/elf_file.h"

namespace mauve::plugin {

/// Refused: loaded segments that overlap, are not in order, or need more than kLargestImage; any
/// other segment that does not lie in one of them. The dynamic linker maps the loaded
/// segments and protects the others also over memory that others use. [any]
Status check_places(const ElfFile& file);

inline constexpr GElf_Xword kLargestImage = GElf_Xword{1} << 30U;  ///< bytes in memory

}  // namespace mauve::plugin
