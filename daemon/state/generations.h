// SPDX-License-Identifier: LGPL-3.0-or-later
/// Saved generations: one file each, an architecture file whose first line, a comment, describes
/// it. Any of them can be started by hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/mutex.h"
#include "mauve/result.h"
#include "state/builds.h"

namespace mauve::daemon {

/// The confirmation of a generation. Only a confirmed one is started after a crash.
enum class Confirmation : std::uint8_t { unconfirmed, confirmed, rolled_back };

/// "unconfirmed", "confirmed", "rolled_back".
[[nodiscard]] std::string_view to_string(Confirmation mark);

/// The commands of a generation that a start made, of the file or after a crash.
inline constexpr const char* kStart = "start";
inline constexpr const char* kRecover = "recover";

/// One saved generation.
struct Generation {
  std::uint64_t number = 0;  ///< goes on over restarts
  std::string boot;          ///< the run of mauved that made it
  std::string time;          ///< UTC, "2026-01-31T12:00:00.000000Z"
  std::uint32_t uid = 0;     ///< of its author
  std::string command;       ///< the method of the wire, "start", "recover"; empty: not known yet
  std::string reason;        ///< as given, may be empty
  std::string changes;       ///< from the one before, in the lines of `plan`, bounded; may be empty
  std::string folder;        ///< where its relative paths begin; empty: not known
  Confirmation mark = Confirmation::confirmed;
  unsigned crashes = 0;  ///< runs in a row that ended by a crash soon after they started it
  Builds builds = {};    ///< of the plugins that it ran with; empty: not known
  bool damaged = false;  ///< its file cannot be read, so that nothing but the number is known
};

/// The files of a directory. A file is written whole or not at all (durable.h), so that a power cut
/// at any point leaves the newest generation as it was saved last. The writer ([disk]) waits
/// for the disk; a reader of the list does not.
class Generations {
 public:
  static constexpr std::size_t kKept = 100;  ///< the newest; and the newest confirmed one

  /// Makes the directory, or reads its files. Damaged files are listed as such. [main]
  [[nodiscard]] static Result<std::unique_ptr<Generations>> open(
      const std::filesystem::path& directory);

  /// Saves an architecture file. A number that is there already keeps its author, once that is
  /// known, and its mark, unless that is `unconfirmed`. It gets the new text and the new builds: a
  /// plugin that comes or goes makes no generation. [disk]
  Status save(const Generation& about, const std::string& text);

  /// [disk] Refused: there is no such generation, or the disk failed.
  Status mark(std::uint64_t number, Confirmation mark);

  /// [disk], or [main] before that runs. The same refusals.
  Status set_crashes(std::uint64_t number, unsigned crashes);
  /// [disk], or [main] before that runs.
  void remove(std::uint64_t number);

  /// [any] Nothing: not there, or damaged.
  [[nodiscard]] std::optional<Generation> find(std::uint64_t number) const;
  /// [any] Newest first.
  [[nodiscard]] std::vector<Generation> list() const;
  /// [any] Nothing: not there, or damaged.
  [[nodiscard]] std::optional<Confirmation> mark_of(std::uint64_t number) const;
  /// [any] The highest number ever seen here, 0 for none.
  [[nodiscard]] std::uint64_t newest() const;

  /// The architecture file of a generation, without its first line. Refused: not there, damaged.
  /// Waits for the disk. [factory]
  [[nodiscard]] Result<std::string> text(std::uint64_t number) const;

  /// Where a generation is, or would be.
  [[nodiscard]] std::filesystem::path file(std::uint64_t number) const;

 private:
  explicit Generations(std::filesystem::path directory) : directory_(std::move(directory)) {}

  void look();
  Status write(const Generation& about, const std::string& text);
  void prune();
  [[nodiscard]] std::uint64_t newest_confirmed() const MAUVE_REQUIRES(mutex_);

  const std::filesystem::path directory_;
  std::uint64_t last_number_ = 0;  ///< [disk] saved last, its text and its builds
  std::string last_text_;
  Builds last_builds_;
  mutable Mutex mutex_;  ///< guards the members below, never held while the disk works
  std::map<std::uint64_t, Generation> known_ MAUVE_GUARDED_BY(mutex_);
  std::uint64_t newest_ MAUVE_GUARDED_BY(mutex_) = 0;
};

}  // namespace mauve::daemon
