// SPDX-License-Identifier: LGPL-3.0-or-later
/// The output of a command goes into the file of --output, or to standard output.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cli/session.h"

namespace mauve::ctl {

/// The form of an output. It may replace only a file of the same form.
struct OutputKind {
  std::string_view begin;                          ///< the first characters of each such file
  std::span<const std::string_view> endings = {};  ///< of the name, if it has any; empty: all
  bool text = true;     ///< can go to standard output, which `-` names as well
  bool folder = false;  ///< a folder, whose file kFolderFile begins so
};
inline constexpr const char* kFolderFile = "metadata";

inline constexpr std::string_view kPictureEndings[] = {".svg"};
inline constexpr OutputKind kPictureOutput{"<svg ", kPictureEndings};

/// The file of --output; empty: standard output.
[[nodiscard]] std::string output_file(const Session& session);
/// The fault of an output that would replace the file that the command reads, or any file but an
/// earlier output of its kind. To be asked before the work begins.
[[nodiscard]] std::optional<Fault> refused_output(const Session& session, const OutputKind& kind);
/// Does the file of --output exist, so that the output replaces it? To be asked before it is
/// written.
[[nodiscard]] bool replaces_file(const Session& session);
/// To the file of --output unless it is refused, or to standard output; then reports it. Returns
/// the exit code.
int write_output(Session& session, const OutputKind& kind, const std::string& text,
                 const std::string& report = {}, Json facts = Json::object(),
                 const std::string& remarks = {});
/// "drew 12 values to drive.svg", or with --json the facts and the file; remarks are lines below.
/// `replaced` is the answer of replaces_file(). Where standard output is the picture, to standard
/// error.
void report_output(Session& session, const std::string& report, Json facts, bool replaced,
                   const std::string& remarks = {});

}  // namespace mauve::ctl
