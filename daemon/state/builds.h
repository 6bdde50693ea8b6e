// SPDX-License-Identifier: LGPL-3.0-or-later
/// The builds of the plugins that run. A saved generation has no code: it records the builds that
/// it ran with, and the code comes from the files of the plugins.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::daemon {

/// The build id of each plugin, by its name. A plugin whose linker wrote none is left out.
using Builds = std::map<std::string, std::string>;

/// A plugin that runs in another build than the recorded one.
struct OtherBuild {
  std::string plugin;
  std::string recorded;
  std::string runs;
  std::string file;  ///< that it was loaded from
};

using OtherBuilds = std::vector<OtherBuild>;

/// [control], or [main] before that runs.
[[nodiscard]] Builds builds_of(const plugin::Catalog& catalog);

/// [control], or [main] before that runs. The plugins of which another build was recorded. One that
/// is not recorded, or is not loaded, is none of them.
[[nodiscard]] OtherBuilds other_builds(const Builds& recorded, const plugin::Catalog& catalog);

/// "9651293e": enough of a build id for people.
[[nodiscard]] std::string short_build(const std::string& build_id);

/// "put build 9651293e in place of /usr/lib/mauve/plugins/slip.so, then mauvectl reload slip"
[[nodiscard]] std::string remedy_of(const OtherBuild& one);

/// A sentence on each of them, for a rollback to this generation, which brings no code back.
[[nodiscard]] std::vector<std::string> notes_on(std::uint64_t generation,
                                                const OtherBuilds& others);

}  // namespace mauve::daemon
