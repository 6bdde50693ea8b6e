// SPDX-License-Identifier: LGPL-3.0-or-later
/// The checks of a plugin's bytes, before any of its code runs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/detail/plugin_entry.h"
#include "mauve/result.h"

namespace mauve::plugin {

/// The facts about a plugin that its bytes show.
struct Facts {
  PluginManifest manifest;
  std::string build_id;               ///< hexadecimal; empty when the linker wrote none
  std::vector<std::string> warnings;  ///< allowed, but it will hurt
  std::vector<std::string> needed;    ///< names of libraries
};

/// Refused: a file that is not a whole shared object of this machine; no manifest, or one of
/// another runtime, compiler or name. Refused: no checksum, or one that does not fit the bytes;
/// tables that lead outside; more than one exported symbol; text relocations, an executable stack.
/// Refused: a search path, thread-local variables, static initialisers, libraries that are not the
/// system's. `at` of the error is empty. [any]; needs no trust in the bytes.
Result<Facts> inspect(std::span<const std::byte> bytes, std::string_view name);

/// The second half: is this the manifest of a plugin `name` for this very runtime?
Status check_manifest(const PluginManifest& manifest, std::string_view name);

}  // namespace mauve::plugin
