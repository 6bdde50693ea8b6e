// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/last_run.h"

#include <fcntl.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdlib>
#include <random>
#include <utility>

#include "arch/build/load.h"
#include "plugin/load/trust.h"
#include "rt/process/process.h"
#include "state/durable.h"

namespace mauve::daemon {

namespace {

using logging::Event;

// The words in `running`, before " started GENERATION" where a run has begun. A run that began not
// long ago writes "machine RUN".
constexpr std::string_view kEnded = "ended";
constexpr std::string_view kRanLong = "ran long";
constexpr std::string_view kRefused = "refused after a crash";
constexpr std::string_view kMachine = "machine ";
constexpr std::string_view kStarted = " started ";

/// Another one after each power cut or restart of the machine; empty: not known. A sandbox may hide
/// the number of the system: then one in the directory that the service manager makes anew.
std::string run_of_the_machine() {
  if (auto number = rt::file_text("/proc/sys/kernel/random/boot_id")) {
    return *std::move(number);
  }
  const char* directory = std::getenv("RUNTIME_DIRECTORY");
  if (directory == nullptr) {
    return "";
  }
  const auto file = std::filesystem::path(directory) / "machine";
  if (auto number = rt::file_text(file)) {
    return *std::move(number);
  }
  std::random_device random;
  const auto number = std::to_string(random()) + "-" + std::to_string(random());
  return replace_file(file, number + "\n") ? number : "";
}

/// The file, if no other user may have written it.
Result<std::string> trusted(const std::filesystem::path& file, logging::Log& log) {
  auto text = arch::read_file(file.string(), &plugin::Trust::of_this_process());
  if (!text && text.error().code == Errc::not_permitted) {
    log.write(Event::path_distrusted,
              {{"text", to_string(text.error())}, {"file", text.error().at}});
  }
  return text;
}

}  // namespace

LastRun::LastRun(const std::filesystem::path& directory, logging::Log& log)
    : running_(directory / "running"),
      continue_(directory / "continue"),
      fault_(directory / "fault"),
      file_crashed_(directory / "file_crashed"),
      log_(log) {}

void LastRun::read(bool generations_are_kept) {
  continues_ = trusted(continue_, log_).has_value();
  const auto marker = trusted(running_.path(), log_);
  std::string_view text = marker ? std::string_view(*marker) : std::string_view();
  text = text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
  crashed_ = marker ? text != kEnded : generations_are_kept;
  const auto started = text.rfind(kStarted);
  if (started == std::string_view::npos) {
    return;
  }
  const auto number = text.substr(started + kStarted.size());
  std::from_chars(number.data(), number.data() + number.size(), began_with_);
  if (!text.starts_with(kMachine)) {
    return;
  }
  const auto machine = text.substr(kMachine.size(), started - kMachine.size());
  const bool ran_on = !machine.empty() && machine == run_of_the_machine();
  crashed_generation_ = ran_on && trusted(fault_, log_) ? began_with_ : 0;
}

void LastRun::try_generation(std::uint64_t generation) {
  started(generation);
  std::error_code ignored;  // the file above could not be written either, which is logged
  std::filesystem::remove(continue_, ignored);
  std::filesystem::remove(fault_, ignored);
  mark_failures();
}

/// The file is made by the last thread of a process that dies, which may not allocate. A signal
/// that somebody sent is no failure, but for that of abort(), which always comes that way.
void LastRun::mark_failures() {
  crash_handler_ = std::make_unique<rt::CrashHandler>();
  const auto speak = [this](const rt::Death& death) {
    const auto& fault = death.fault;
    const bool sent = fault.sent && fault.signal != 0 && fault.signal != SIGABRT;
    if (sent || !may_fail_.load()) {
      return;
    }
    const int file = ::open(fault_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file >= 0) {
      ::close(file);
    }
  };
  if (auto started = crash_handler_->start(speak); !started) {
    log_.write(Event::run_not_recorded, {{"text", to_string(started.error())}});
  }
}

void LastRun::started(std::uint64_t generation) {
  started_ = generation;
  put(std::string(kMachine) + run_of_the_machine(), generation);
}

void LastRun::ran_long() { put(kRanLong, started_); }

void LastRun::refused() {
  return crashed_ || continues_ ? put(kRefused, began_with_) : put(kEnded);
}

void LastRun::ended() {
  ends_by_order();
  put(kEnded);
  std::error_code ignored;
  std::filesystem::remove(file_crashed_, ignored);
}

void LastRun::file_crashed() {
  if (auto put = replace_file(file_crashed_, "the file of the last start\n"); !put) {
    log_.write(Event::run_not_recorded, {{"text", to_string(put.error())}});
  }
}

bool LastRun::has_crashed(const std::filesystem::path& architecture) const {
  std::error_code unknown;
  const auto changed = std::filesystem::last_write_time(architecture, unknown);
  const auto crashed = std::filesystem::last_write_time(file_crashed_, unknown);
  return !unknown && crashed >= changed;
}

void LastRun::put(std::string_view words, std::uint64_t began_with) {
  put(std::string(words) + std::string(kStarted) + std::to_string(began_with));
}

void LastRun::put(std::string_view text) {
  if (auto put = running_.replace(std::string(text) + "\n"); !put) {
    log_.write(Event::run_not_recorded,
               {{"text", to_string(put.error())}, {"file", put.error().at}});
  }
}

}  // namespace mauve::daemon
