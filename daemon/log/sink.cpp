// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/sink.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/sinks/basic_file_sink.h>

#include "log/json_text.h"

namespace mauve::logging {

namespace {

spdlog::level::level_enum spdlog_level(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warn:
      return spdlog::level::warn;
    case Level::error:
      break;
  }
  return spdlog::level::err;
}

/// A spdlog logger as a Sink. spdlog catches the exceptions of its sinks and calls the error
/// handler.
class SpdlogSink : public Sink {
 public:
  SpdlogSink(spdlog::sink_ptr sink, const std::string& pattern, std::string target)
      : logger_("mauved", std::move(sink)), target_(std::move(target)) {
    logger_.set_level(spdlog::level::trace);
    logger_.set_pattern(pattern, spdlog::pattern_time_type::utc);
    logger_.set_error_handler([this](const std::string& why) { failure_ = why; });
  }

  Status write(const Record& record) override {
    failure_.clear();
    // spdlog says "warning" for %l; the file name of a record, %s, is free for the word of mauve.
    const spdlog::source_loc word{to_string(record.level).data(), 1, ""};
    logger_.log(record.time, word, spdlog_level(record.level), line(record));
    return result();
  }

  void flush() override { logger_.flush(); }

 protected:
  virtual std::string line(const Record& record) = 0;

 private:
  [[nodiscard]] Status result() const {
    return failure_.empty() ? ok() : refuse({Errc::system, "log_not_written"}, target_, failure_);
  }

  spdlog::logger logger_;
  std::string target_;
  std::string failure_;
};

class TerminalSink final : public SpdlogSink {
 public:
  TerminalSink()
      : SpdlogSink(std::make_shared<spdlog::sinks::ansicolor_stderr_sink_mt>(),
                   "%Y-%m-%dT%H:%M:%S.%eZ %^%-7s%$ %v", "the terminal") {}

 private:
  /// Texts of clients and cores are among it: none of them may forge a line or colour the terminal.
  std::string line(const Record& record) override {
    return printable(record.component.empty() ? record.text
                                              : record.component + ": " + record.text);
  }
};

class FileSink final : public SpdlogSink {
 public:
  explicit FileSink(const std::filesystem::path& path)
      : SpdlogSink(std::make_shared<spdlog::sinks::basic_file_sink_mt>(path.string()), "%v",
                   path.string()) {}

 private:
  std::string line(const Record& record) override { return to_json_line(record); }
};

}  // namespace

std::unique_ptr<Sink> terminal_sink() { return std::make_unique<TerminalSink>(); }

Result<std::unique_ptr<Sink>> file_sink(const std::filesystem::path& path) {
  // Made here with its mode and checked before spdlog opens it, which would answer by an exception.
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY, 0640);
  if (fd < 0) {
    return refuse({Errc::system, "log_not_written"}, path.string(),
                  fmt::format("cannot open the log file: {}", std::strerror(errno)),
                  "name a file in an existing directory that this user may write to");
  }
  close(fd);
  return std::unique_ptr<Sink>(std::make_unique<FileSink>(path));
}

bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || fstat(STDERR_FILENO, &status) != 0) {
    return false;
  }
  return fmt::format("{}:{}", status.st_dev, status.st_ino) == stream;
}

}  // namespace mauve::logging
