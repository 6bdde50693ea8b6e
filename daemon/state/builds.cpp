// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/builds.h"

#include <cstddef>

#include "plugin/load/catalog.h"

namespace mauve::daemon {

Builds builds_of(const plugin::Catalog& catalog) {
  Builds builds;
  for (const auto* loaded : catalog.plugins()) {
    const auto& info = loaded->info();
    if (!info.build_id.empty()) {
      builds.emplace(info.name, info.build_id);
    }
  }
  return builds;
}

OtherBuilds other_builds(const Builds& recorded, const plugin::Catalog& catalog) {
  OtherBuilds others;
  for (const auto& [plugin, build] : builds_of(catalog)) {
    const auto found = recorded.find(plugin);
    if (found != recorded.end() && found->second != build) {
      others.push_back({plugin, found->second, build, catalog.find(plugin)->info().file});
    }
  }
  return others;
}

std::string short_build(const std::string& build_id) {
  constexpr std::size_t kEnough = 8;
  return build_id.substr(0, kEnough);
}

std::string remedy_of(const OtherBuild& one) {
  return "put build " + short_build(one.recorded) + " in place of " + one.file +
         ", then mauvectl reload " + one.plugin;
}

std::vector<std::string> notes_on(std::uint64_t generation, const OtherBuilds& others) {
  std::vector<std::string> notes;
  for (const auto& one : others) {
    notes.push_back("generation " + std::to_string(generation) + " ran build " +
                    short_build(one.recorded) + " of " + one.plugin + ", and build " +
                    short_build(one.runs) + " runs: a rollback brings no code back; " +
                    remedy_of(one));
  }
  return notes;
}

}  // namespace mauve::daemon
