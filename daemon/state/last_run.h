// SPDX-License-Identifier: LGPL-3.0-or-later
/// How the run before this one ended, and how far this one came: the files `running` and `continue`
/// of the state directory. All functions but those of [any] wait for the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "log/log.h"

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
  /// [any] The generation with which the run had started, if it crashed soon after its start while
  /// the machine ran on; 0: no such crash.
  [[nodiscard]] std::uint64_t crashed_generation() const { return crashed_generation_; }
  /// [any] The generation that the run, or a start refused after its crash, began with; 0: not
  /// known.
  [[nodiscard]] std::uint64_t began_with() const { return began_with_; }

  /// started(), and the file `continue` goes: it is for one start. [main]
  void try_generation(std::uint64_t generation);
  /// From now on an end without ended() or refused() is a crash of this generation. [main]
  void started(std::uint64_t generation);
  /// The end of this run would be no crash soon after its start. [disk]
  void ran_long();
  /// This run is refused before it began: the next one starts with the same. [main]
  void refused();
  void ended();

 private:
  void put(std::string_view text);
  void put(std::string_view words, std::uint64_t began_with);

  const std::filesystem::path running_;
  const std::filesystem::path continue_;
  logging::Log& log_;
  bool crashed_ = false;
  bool continues_ = false;
  std::uint64_t crashed_generation_ = 0;
  std::uint64_t began_with_ = 0;  ///< the run before
  std::uint64_t started_ = 0;     ///< this run
};

}  // namespace mauve::daemon
