// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "navigation/map_server": a map out of a file (map_file.h), read when the core is
/// configured. It is written every `fsm.period`, for readers that come later; its `time` states
/// that it is still the same. Another map: mauvectl set map_server.core.file=maps/other.yaml
#include <memory>
#include <string>

#include <mauve/job.h>

#include "map_file.h"
#include "parts.h"

namespace navigation {
namespace {

using namespace std::chrono_literals;  // NOLINT: durations of states

struct MapServerShell : mauve::Shell {
  mauve::WritePort<OccupancyGrid> map{*this, "map"};
};

class MapServer final : public mauve::Core<MapServerShell> {
 public:
  void publish() {
    // Unlike that of any map before it: those were given in earlier jobs.
    if (map_->time == 0.0) map_->time = mauve::to_seconds(mauve::job_time());
    shell().map.write(*map_);
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> file{
      *this, "file", "", "path of the map's YAML file", {.within = "./"}};
  mauve::Observable<int> width{*this, "width", 0, "cells"};
  mauve::Observable<int> height{*this, "height", 0, "cells"};

  mauve::Status on_configure() override {
    if (file.get().empty()) return mauve::invalid(file, "says no file");
    auto map = std::make_unique<OccupancyGrid>();
    bool frees_unknown = false;
    if (mauve::Status done = load_map(file, *map, frees_unknown); !done) return done;
    if (frees_unknown) {
      mauve::log(mauve::LogLevel::warning,
                 "free_thresh makes cells of the level 205 free, by which map_saver means unknown: "
                 "0.196 leaves them unknown");
    }
    width = map->width;
    height = map->height;
    map_ = std::move(map);
    return mauve::ok();
  }
  void on_cleanup() override { map_.reset(); }

  std::unique_ptr<OccupancyGrid> map_;
};

struct MapServerFsm : mauve::Fsm<MapServer> {
  Exec publish{*this, "publish", &MapServer::publish};
  Sync period{*this, "period", 2s, "between two times the same map is written"};

  mauve::Status on_configure() override {
    start_at(publish);
    publish.then(period);
    period.then(publish);
    return mauve::ok();
  }
};

}  // namespace

void declare_map_server(mauve::Plugin& plugin) {
  plugin.component<MapServerShell, MapServer, MapServerFsm>("map_server");
}

}  // namespace navigation
