// SPDX-License-Identifier: LGPL-3.0-or-later
/// Damage of a plugin file is noticed before the dynamic linker reads it. The linker trusts every
/// table in the file: one changed bit in it can end the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "mauve/result.h"
#include "plugin/elf/elf_file.h"

namespace mauve::plugin {

/// The one symbol that a plugin exports: its manifest, then its function that declares types.
inline constexpr std::string_view kEntry = "mauve_plugin";

/// Where the manifest lies in the file. Refused: no plugin, or damaged so that it is not found.
[[nodiscard]] Result<std::size_t> find_manifest(const ElfFile& file);

/// FNV-1a of the program headers and of all bytes that are mapped (PT_LOAD), without the checksum
/// itself and the fields that locate the section headers, which strip(1) changes. It notices
/// damage; against an attacker, who can write a new one, the file is protected by its owner and
/// mode.
[[nodiscard]] std::uint64_t checksum_of(const ElfFile& file, std::span<const std::byte> bytes,
                                        std::size_t manifest);

/// Writes the checksum into the manifest, as the last step of building a plugin.
[[nodiscard]] Status stamp(std::span<std::byte> bytes);

}  // namespace mauve::plugin
