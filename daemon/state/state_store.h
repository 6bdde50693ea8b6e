// SPDX-License-Identifier: LGPL-3.0-or-later
/// The data that outlive a run of mauved, in its state directory: generations, audit log, and
/// whether the last run came to its end. The thread [disk] writes them, so a slow disk delays no
/// change.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/mutex.h"
#include "changes/control.h"
#include "log/log.h"
#include "mauve/host/value.h"
#include "protocol/framing.h"
#include "rt/process/descriptor.h"
#include "state/generations.h"
#include "state/last_run.h"
#include "state/stops/kept_stops.h"

namespace mauve::daemon {

class StateStore {
 public:
  using Json = protocol::Json;

  /// Makes the directory where it is missing. Refused: no rights, or another mauved has it. [main]
  [[nodiscard]] static Result<std::unique_ptr<StateStore>> open(const std::string& directory,
                                                                logging::Log& log);

  /// How the run before this one ended, and how far this one came.
  [[nodiscard]] LastRun& last_run() { return last_run_; }
  [[nodiscard]] const LastRun& last_run() const { return last_run_; }
  [[nodiscard]] const Generations& generations() const { return *generations_; }
  /// [main], before begin()
  [[nodiscard]] Generations& generations() { return *generations_; }
  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// [any] Its write() belongs before all that waits for the disk.
  [[nodiscard]] KeptStops& stops() { return stops_; }

  /// Saves the generation that this run starts with, waiting for the disk, and begins to write on
  /// [disk]. The unconfirmed start of a run that crashed is removed. `recovered`: the saved
  /// generation from which it starts; 0: none. [main]
  void begin(const Generation& first, const Value& architecture, std::uint64_t recovered = 0);
  /// Writes all that waits, then records the end of the run. [main]
  void end();

  /// The mark of a new generation: its own one, confirmed also when it was saved already, or the
  /// mark of the one before it.
  enum class As : std::uint8_t { marked, confirmed, before };

  /// Saves a generation, adds `line` to the audit log with "saved", then calls `then` on [disk].
  /// "saved" includes its mark. Only stops made the generations after `before_stops`. [any but rt]
  void keep(Generation about, Value architecture, Json line, std::function<void(bool saved)> then,
            As as, std::uint64_t before_stops);
  /// Adds a line to the audit log, for which no thread waits. When too many are on their way, lines
  /// are lost and counted. [any but rt]
  void audit(const Json& line);
  /// Marks a saved generation, after the jobs that wait for [disk]. [any but rt]
  void mark(std::uint64_t generation, Confirmation mark);
  /// Its run did not end by a crash soon after its start. [any but rt]
  void forget_crashes(std::uint64_t generation);
  /// Confirms both when they are the same architecture. [any but rt]
  void confirm_same(std::uint64_t generation, std::uint64_t other);
  /// Confirms a saved generation; then `replaced`, which has the same architecture, is needed no
  /// more (0: none). [any but rt]
  void confirm_start(std::uint64_t generation, std::uint64_t replaced);
  /// The run has gone on for so long that its end would be no crash soon after a start. [any but
  /// rt]
  void ran_long();
  /// [any but rt] The thread [disk]: a posted job runs after those that wait there.
  [[nodiscard]] WorkerThread& disk() { return disk_; }
  /// Saves the list of cores in quarantine. [any but rt]
  void quarantine(Json cores);
  /// [main] The list as the run before left it.
  [[nodiscard]] const Json& quarantined() const { return quarantined_; }
  /// [any but rt] Waits until the data of all calls so far is on the disk, or could not be written.
  void flush();

  /// [any] False when the disk did not take the newest generation.
  [[nodiscard]] bool saved() const { return saved_; }

  static constexpr std::size_t kWaiting = 4096;  ///< audit lines

 private:
  StateStore(std::string directory, logging::Log& log)
      : directory_(std::move(directory)), log_(log) {}

  bool save(const Generation& about, const Value& architecture);
  bool save_cores();
  void end_row_of_crashes();
  [[nodiscard]] Confirmation mark_before(std::uint64_t generation,
                                         std::uint64_t before_stops) const;
  bool mark_now(std::uint64_t generation, Confirmation mark);
  void put_aside(const std::filesystem::path& folder);
  void read_quarantine();
  void write_waiting();
  [[nodiscard]] Status rotate_audit() const;
  void write_lines(const std::string& lines);
  void report(logging::Event event, const Error& error);

  const std::string directory_;
  logging::Log& log_;
  rt::Descriptor held_;
  std::unique_ptr<Generations> generations_;
  LastRun last_run_{directory_, log_};
  KeptStops stops_{directory_, log_};
  Json quarantined_ = Json::array();
  std::atomic<bool> saved_{true};
  std::optional<Json> unsaved_cores_;  ///< [disk] in quarantine
  std::uint64_t first_ = 0;            ///< of this run
  std::uint64_t recovered_ = 0;        ///< from which this run started; 0: none
  std::uint64_t newest_ = 0;           ///< [disk] that was to be saved, and its mark if it was not
  Confirmation newest_mark_ = Confirmation::unconfirmed;
  bool audit_broken_ = false;  ///< [disk] one complaint each until it works again
  Mutex mutex_;                ///< guards the members below
  std::vector<std::string> waiting_ MAUVE_GUARDED_BY(mutex_);
  std::uint64_t lost_ MAUVE_GUARDED_BY(mutex_) = 0;
  WorkerThread disk_{ThreadRole::disk};
};

}  // namespace mauve::daemon
