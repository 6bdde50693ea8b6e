// SPDX-License-Identifier: LGPL-3.0-or-later
/// From an architecture file to an Architecture, in one call.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "arch/build/build.h"
#include "arch/parse/spec.h"
#include "arch/text/problem.h"
#include "plugin/load/trust.h"

namespace mauve {
class Architecture;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// The text of a file. Refused: not there, not readable, no regular file, longer than parse()
/// takes; with `trust` also a symbolic link, and a file that Trust::check() refuses. `at` of the
/// error is the path. Never waits for the other end of a FIFO.
[[nodiscard]] Result<std::string> read_file(const std::string& path,
                                            const plugin::Trust* trust = nullptr);

/// Loads the plugins that the file names and the catalog does not have yet. [control] and
/// [factory] in one: for a daemon that starts, a check, or a program with one thread.
void load_plugins(const Spec& spec, plugin::Catalog& catalog, Problems& problems);

/// Parses the file, loads its plugins and builds the architecture, of which only the state machines
/// are configured. The problems of all three steps are reported together, and the result is then
/// null. The rules of the file go to `supervision`, when that is given. `lost`: see build().
[[nodiscard]] std::unique_ptr<Architecture> load(std::string_view text, plugin::Catalog& catalog,
                                                 Problems& problems,
                                                 rules::Supervision* supervision = nullptr,
                                                 LostNames lost = LostNames::refused);

}  // namespace mauve::arch
