// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/sink.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "log/json_text.h"
#include "log/lines.h"

namespace mauve::logging {

namespace {

constexpr std::size_t kMilliseconds = 23;  ///< of "2026-01-01T00:00:00.000000Z"

/// The colour of the word of a level: cyan, green, bold yellow, bold red.
std::string_view colour_of(Level level) {
  constexpr std::array<std::string_view, 4> kColours{"\033[36m", "\033[32m", "\033[33m\033[1m",
                                                     "\033[31m\033[1m"};
  return kColours.at(static_cast<std::size_t>(level));
}

bool stderr_has_colours() {
  const char* const terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal != nullptr &&
         std::string_view(terminal) != "dumb" && std::getenv("NO_COLOR") == nullptr;
}

/// A caller may close it, as for a program whose log is a file: that is no failure.
bool stderr_takes_text() {
  const int flags = fcntl(STDERR_FILENO, F_GETFL);
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

class TerminalSink final : public Sink {
 public:
  Status write(const Record& record) override {
    if (!open_) {
      return ok();
    }
    const auto word = fmt::format("{:<7}", to_string(record.level));
    const auto level = coloured_ ? fmt::format("{}{}\033[m", colour_of(record.level), word) : word;
    // Texts of clients and cores are among it: none of them may forge a line or colour the
    // terminal.
    const auto text =
        printable(record.component.empty() ? record.text : record.component + ": " + record.text);
    return append_line(
        STDERR_FILENO, "standard error",
        fmt::format("{}Z {} {}", utc(record.time).substr(0, kMilliseconds), level, text), state_);
  }

 private:
  const bool open_ = stderr_takes_text();
  const bool coloured_ = stderr_has_colours();
  LineState state_;
};

class FileSink final : public Sink {
 public:
  explicit FileSink(RotatedFile file) : file_(std::move(file)) {}

  Status write(const Record& record) override { return file_.append(to_json_line(record)); }

 private:
  RotatedFile file_;
};

}  // namespace

std::unique_ptr<Sink> terminal_sink() { return std::make_unique<TerminalSink>(); }

Result<std::unique_ptr<Sink>> file_sink(const std::filesystem::path& path) {
  RotatedFile file(path.string());
  if (auto opened = file.open(); !opened) {
    return opened.error();
  }
  return std::unique_ptr<Sink>(std::make_unique<FileSink>(std::move(file)));
}

bool journal_answers() {
  const rt::Descriptor probe(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_un journal{AF_UNIX, "/run/systemd/journal/socket"};
  // Without a descriptor to ask with, the journal may be there all the same.
  return !probe ||
         connect(probe.get(), reinterpret_cast<const sockaddr*>(&journal), sizeof journal) == 0 ||
         (errno != ENOENT && errno != ENOTDIR && errno != ECONNREFUSED);
}

bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || fstat(STDERR_FILENO, &status) != 0) {
    return false;
  }
  return fmt::format("{}:{}", status.st_dev, status.st_ino) == stream && journal_answers();
}

}  // namespace mauve::logging
