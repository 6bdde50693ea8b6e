// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/laser_replay": a laser that plays a recording, one scan each period. The
/// file is read when the core is configured; replaying does no I/O. At its end it begins again or,
/// without `repeat`, falls silent. Example: mauvectl get laser.core.scans
#include <cstdint>
#include <string>

#include "../../types/scan.h"
#include "../parts.h"
#include "../recording/recording.h"

namespace drivers {

/// The state that survives a change.
struct ReplayPosition {
  std::uint64_t next = 0;

  static constexpr std::string_view type_name = "replay_position/1";
  static constexpr auto fields() { return std::tuple{mauve::field("next", &ReplayPosition::next)}; }
};

namespace {

using rover::LaserScan;

struct LaserReplayShell : mauve::Shell {
  mauve::WritePort<LaserScan> scan{*this, "scan"};
};

class LaserReplay final : public mauve::Core<LaserReplayShell> {
 public:
  void update() {
    if (state->next >= recording_->size() && repeat) state->next = 0;
    finished = state->next >= recording_->size();
    if (finished) return;
    shell().scan.fill([&](LaserScan& scan) {
      recording_->show(state->next++, scan);
      scan.time = mauve::to_seconds(mauve::job_time());  // the recording has another clock
    });
    ++scans;
  }

 private:
  mauve::State<ReplayPosition> state{*this};
  mauve::Property<std::string> recording{
      *this, "recording", "", "path of the file", {.within = "./"}};
  mauve::Property<bool> repeat{*this, "repeat", false, "begin again at the end"};
  mauve::Observable<std::uint64_t> scans{*this, "scans", 0, "published"};
  mauve::Observable<bool> finished{*this, "finished", false, "nothing more to come"};

  mauve::Status on_configure() override {
    if (recording.get().empty()) return mauve::invalid(recording, "says no file");
    mauve::Result<Recording> loaded = Recording::load(recording);
    if (!loaded) return loaded.error();
    recording_ = std::move(*loaded);
    return mauve::ok();
  }
  void on_cleanup() override { recording_.reset(); }

  std::optional<Recording> recording_;
};

}  // namespace

void declare_laser_replay(mauve::Plugin& plugin) {
  plugin.component<LaserReplayShell, LaserReplay, mauve::PeriodicFsm<LaserReplay>>("laser_replay");
}

}  // namespace drivers
