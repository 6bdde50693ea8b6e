// SPDX-License-Identifier: LGPL-3.0-or-later
/// The judgement of an architecture file before any part of it runs. Making the elements runs code
/// of plugins, so a process of its own judges the file: see judge.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arch/text/problem.h"
#include "plugin/load/catalog.h"
#include "protocol/framing.h"
#include "state/builds.h"

namespace mauve::arch {
struct Line;
}  // namespace mauve::arch

namespace mauve::daemon {

using protocol::Json;

/// Where a refusal is that knows no nearer place.
inline constexpr const char* kWholeFile = "file";

/// A file, and with which eyes it is looked at.
struct Question {
  std::string text;
  /// The architecture that `text` is compared with, also as the text of a file; none: `text` is
  /// only checked.
  std::optional<std::string> running = std::nullopt;
  std::vector<std::string> loaded = {};  ///< plugins that run already
  Builds builds = {};                    ///< of these, for notes; empty: without notes
  bool loads = false;        ///< the file may name others too: the caller may load plugins
  bool lists_cores = false;  ///< of a good file, the result lists the cores with their builds
  bool ran = false;          ///< it is a system that ran: see arch::LostNames
};

[[nodiscard]] Json to_json(const Question& question);
/// Of the text that to_json() gives; nothing when it makes no sense.
[[nodiscard]] std::optional<Question> question_of(const std::string& text);

/// {"errors":[...],"notes"?} and, when the files are compared and good,
/// {"same","lines","exchanged"?}. When it was asked for and the file is good,
/// {"cores":[{"component","core","build_id"}]}. Refused when the running architecture cannot be
/// made from the plugin files of now. Loads plugins into `catalog` and makes all elements.
[[nodiscard]] Result<Json> judge(const Question& question, plugin::Catalog catalog);

/// [{"line","column","at","code","message","hint"}], in the order of the file: the first 200, and
/// then how many more.
[[nodiscard]] Json to_json(const arch::Problems& problems);
/// {"op","kind","address","old","new"}
[[nodiscard]] Json to_json(const arch::Line& line);
/// Of the lines that to_json() gives.
[[nodiscard]] std::vector<arch::Line> lines_of(const Json& lines);

}  // namespace mauve::daemon
