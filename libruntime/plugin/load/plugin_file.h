// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finding a plugin by name in the directories of the operator, and nowhere else.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/result.h"
#include "plugin/load/trust.h"

namespace mauve::plugin {

/// The bytes of a plugin file as they were when it was read: the checked bytes are those that will
/// run.
struct PluginFile {
  std::string name;  ///< "guidance"
  std::string path;  ///< "/usr/lib/mauve/plugins/guidance.so"
  std::vector<std::byte> bytes;
  std::vector<std::string> hides;  ///< files of this name in later directories, which nothing reads
};

inline constexpr std::size_t kLargestPlugin = std::size_t{256} << 20;

/// The directory of the installed plugins, in which mauved looks without --plugin-dir. A build tree
/// and an installed copy have the same shape; a program elsewhere uses the latter.
std::string installed_directory();

/// Reads NAME.so from the first directory that has it, and names those in the others. Refused: a
/// text that is not a name, a symbolic link, a special file, more than 256 MiB. Refused: a file
/// that `trust` refuses, also for any directory above it. Waits for the disk. [any but control and
/// rt]
Result<PluginFile> read_plugin_file(const std::vector<std::string>& directories,
                                    std::string_view name, const Trust& trust);

/// The build id of the file that read_plugin_file() finds, with the same refusals; also refused: a
/// file that cannot be loaded. No code of it runs.
Result<std::string> build_on_disk(const std::vector<std::string>& directories,
                                  std::string_view name, const Trust& trust);

}  // namespace mauve::plugin
