// SPDX-License-Identifier: LGPL-3.0-or-later
/// The places that the dynamic linker writes while it maps a plugin, and the functions it calls.
#pragma once

#include "mauve/result.h"
#include "plugin/elf/elf_file.h"

namespace mauve::plugin {

/// Refused: a relocation that writes outside of the plugin's data, that takes a symbol which is not
/// in its table, or that makes an address outside of the plugin. Refused: a function for the start
/// or the end that does not lie in the plugin's code. The memory around a plugin differs from
/// process to process, so a trial elsewhere proves nothing. [any]
Status check_relocations(const ElfFile& file);

}  // namespace mauve::plugin
