// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/output.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "cli/files.h"

namespace mauve::ctl {
namespace {

namespace fs = std::filesystem;

std::string joined(std::span<const std::string_view> endings) {
  std::string text;
  for (const std::string_view ending : endings) {
    const bool last = ending == endings.back() && !text.empty();
    text += (text.empty() ? "" : last ? " or " : ", ") + std::string(ending);
  }
  return text;
}

/// An empty file is of any kind.
bool begins_with(const fs::path& file, std::string_view begin) {
  std::ifstream stream(file, std::ios::binary);
  std::string found(begin.size(), '\0');
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  return stream.gcount() == 0 ? fs::file_size(file) == 0 : found == begin;
}

/// /dev/null, /dev/stdout, or a pipe that has a name: nothing in it can be lost.
bool is_written_in_place(const fs::path& file) {
  std::error_code none;
  const fs::file_status found = fs::status(file, none);
  return fs::is_character_file(found) || fs::is_fifo(found);
}

/// A folder that is empty is of that kind too.
bool replaceable(const fs::path& file, const OutputKind& kind) {
  std::error_code none;
  const fs::file_status found = fs::symlink_status(file, none);
  if (!fs::exists(found)) return true;
  if (is_written_in_place(file)) return !kind.folder;
  if (!kind.folder) return fs::is_regular_file(found) && begins_with(file, kind.begin);
  if (!fs::is_directory(found)) return false;
  return fs::is_empty(file, none) || (fs::is_regular_file(file / kFolderFile, none) &&
                                      begins_with(file / kFolderFile, kind.begin));
}

}  // namespace

std::string output_file(const Session& session) {
  const std::string file = session.arguments.one("-o,--output");
  return file == "-" ? std::string() : file;
}

std::optional<Fault> refused_output(const Session& session, const OutputKind& kind) {
  const std::string file = output_file(session);
  if (file.empty()) {
    if (kind.text || !session.arguments.has("-o,--output")) return std::nullopt;
    return protocol::wrong_use("usage_unknown_form", "a trace does not go to standard output", "-",
                               "-o names a file or a folder; ./- is a file of the name -");
  }
  const fs::path path(file);
  const auto is_end = [&](std::string_view end) { return file.ends_with(end); };
  if (!kind.endings.empty() && path.has_extension() && std::ranges::none_of(kind.endings, is_end)) {
    return protocol::wrong_use("usage_unknown_form", "the name of the file does not say its form",
                               file, "end it with " + joined(kind.endings));
  }
  std::error_code none;
  if (fs::equivalent(session.arguments.one("FILE"), path, none)) {
    return bad_file(refuse({Errc::duplicate, "file_exists"}, file,
                           "is the file that the command reads, so it is not replaced",
                           "name another file with -o"));
  }
  if (replaceable(path, kind)) return std::nullopt;
  return bad_file(refuse({Errc::duplicate, "file_exists"}, file,
                         "exists and is no earlier output of this kind, so it is not replaced",
                         "name another file with -o, or move this one away"));
}

bool replaces_file(const Session& session) {
  const fs::path file = output_file(session);
  std::error_code none;
  // A trace in the form of CTF is a folder.
  return fs::is_regular_file(file, none) || fs::is_regular_file(file / kFolderFile, none);
}

void report_output(Session& session, const std::string& report, Json facts, bool replaced,
                   const std::string& remarks) {
  const std::string file = output_file(session);
  if (file.empty()) {
    if (!report.empty()) session.screen.err << report << "\n" << remarks << std::flush;
    return;
  }
  facts["file"] = file;
  facts["replaced"] = replaced;
  const std::string way = replaced ? ", replacing the file of that name\n" : "\n";
  session.print(facts, (report.empty() ? "" : report + " to " + file + way) + remarks);
}

int write_output(Session& session, const OutputKind& kind, const std::string& text,
                 const std::string& report, Json facts, const std::string& remarks) {
  // Somebody may have made the file while the command listened.
  if (const auto fault = refused_output(session, kind)) return session.fail(*fault);
  const std::string file = output_file(session);
  const bool replaced = replaces_file(session);
  if (file.empty()) {
    session.screen.out << text << std::flush;
  } else if (const Status done = write_file(file, [&](std::ostream& out) { out << text; }); !done) {
    return session.fail(bad_file(done.error()));
  }
  report_output(session, report, std::move(facts), replaced, remarks);
  return 0;
}

}  // namespace mauve::ctl
