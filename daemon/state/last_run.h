// SPDX-License-Identifier: LGPL-3.0-or-later
/// How the run before this one ended, and how far this one came: the files `running`, `fault` and
/// `continue` of the state directory. All functions but those of [any] wait for the disk.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "log/log.h"
#include "rt/thread/crash_handler.h"
#include "state/stops/kept_file.h"

namespace mauve::daemon {

class LastRun {
 public:
  LastRun(const std::filesystem::path& directory, logging::Log& log);

  /// If the file `running` is lost although generations are kept, the run counts as crashed, since
  /// an end leaves this file. A file that others may have written is not believed. [main]
  void read(bool generations_are_kept);

  /// [any] The run did not come to its end: a crash, a power cut.
  [[nodiscard]] bool crashed() const { return crashed_; }
  /// [any] The file `continue` is there: this start goes on with the last confirmed generation,
  /// although the run came to its end. An upgrade of the package leaves this file.
  [[nodiscard]] bool continues() const { return continues_; }
  /// [any] The generation with which the run had started, if the process itself failed soon after
  /// its start; 0: no such failure. A kill from outside and a power cut leave no file `fault`: they
  /// say nothing about the generation.
  [[nodiscard]] std::uint64_t crashed_generation() const { return crashed_generation_; }
  /// [any] The generation that the run, or a start refused after its crash, began with; 0: not
  /// known.
  [[nodiscard]] std::uint64_t began_with() const { return began_with_; }

  /// started(), and the files `continue` and `fault` go: they are for one start. From now on a
  /// failure of the process leaves the latter. [main]
  void try_generation(std::uint64_t generation);
  /// From now on an end without ended() or refused() is a crash of this generation. [main]
  void started(std::uint64_t generation);
  /// The end of this run would be no crash soon after its start. [disk]
  void ran_long();
  /// This run is refused before it began: the next one starts with the same. [main]
  void refused();
  void ended();
  /// The file of the command line crashed after a start of it; until the file changes or a run
  /// comes to its end, has_crashed() is true for it. [main]
  void file_crashed();
  [[nodiscard]] bool has_crashed(const std::filesystem::path& architecture) const;
  /// From now on the end of the process is no failure, however it comes. [any]
  void ends_by_order() { may_fail_.store(false); }

 private:
  void mark_failures();
  void put(std::string_view text);
  void put(std::string_view words, std::uint64_t began_with);

  KeptFile running_;
  const std::filesystem::path continue_;
  const std::string fault_;
  const std::filesystem::path file_crashed_;
  logging::Log& log_;
  bool crashed_ = false;
  bool continues_ = false;
  std::uint64_t crashed_generation_ = 0;
  std::uint64_t began_with_ = 0;  ///< the run before
  std::uint64_t started_ = 0;     ///< this run
  std::atomic<bool> may_fail_{true};
  std::unique_ptr<rt::CrashHandler> crash_handler_;
};

}  // namespace mauve::daemon
