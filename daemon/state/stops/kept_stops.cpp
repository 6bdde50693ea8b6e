// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/stops/kept_stops.h"

#include <chrono>
#include <optional>
#include <utility>

#include "arch/build/load.h"
#include "plugin/load/trust.h"
#include "protocol/framing.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using protocol::Json;

Json json_of(const UserStop& stop) {
  if (!stop.cause.empty()) {
    return {{"cause", stop.cause}, {"time", stop.time}};
  }
  return {{"uid", stop.uid}, {"time", stop.time}};
}

std::string text_of(const UserStops& stops) {
  Json json = {{"components", Json::object()}};
  for (const auto* some : {&stops.named(), &stops.ended()}) {
    for (const auto& [name, stop] : *some) {
      if (some == &stops.named() || stops.of(name) == nullptr) {
        json["components"][name] = json_of(stop);
      }
    }
  }
  if (stops.all()) {
    json["all"] = json_of(*stops.all());
    json["started"] = stops.started();
  }
  return protocol::to_line(json) + "\n";
}

std::optional<UserStop> stop_in(const Json& json) {
  if (!json.is_object() || !json.contains("time") || !json["time"].is_string()) {
    return std::nullopt;
  }
  const auto time = json["time"].get<std::string>();
  const auto cause = json.find("cause");
  if (cause != json.end() && cause->is_string() && *cause != "") {
    return UserStop{0, time, 0, cause->get<std::string>()};
  }
  const auto uid = json.find("uid");
  if (cause != json.end() || uid == json.end() || !uid->is_number_unsigned()) {
    return std::nullopt;
  }
  return UserStop{uid->get<std::uint32_t>(), time, 0};
}

/// Nothing: the text is no such list.
std::optional<UserStops> stops_in(const std::string& text) {
  const auto json = protocol::parse_json(text);
  if (!json || !json->is_object() || !json->contains("components") ||
      !(*json)["components"].is_object()) {
    return std::nullopt;
  }
  UserStops stops;
  if (json->contains("all")) {
    const auto all = stop_in((*json)["all"]);
    if (!all || !json->contains("started") || !(*json)["started"].is_array()) {
      return std::nullopt;
    }
    stops.stop_all(*all);
    for (const auto& name : (*json)["started"]) {
      if (!name.is_string()) {
        return std::nullopt;
      }
      stops.start(name.get<std::string>(), stops.newest());
    }
  }
  for (const auto& [name, one] : (*json)["components"].items()) {
    const auto stop = stop_in(one);
    if (!stop) {
      return std::nullopt;
    }
    stops.stop(name, *stop);
  }
  return stops;
}

bool is_empty(const UserStops& stops) {
  return stops.named().empty() && stops.ended().empty() && !stops.all();
}

}  // namespace

KeptStops::KeptStops(const std::filesystem::path& directory, logging::Log& log)
    : file_(directory / "stops.json"), log_(log) {}

UserStops KeptStops::read() const {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file_.path(), ignored))) {
    return {};
  }
  const auto text = arch::read_file(file_.path().string(), &plugin::Trust::of_this_process());
  const auto stops = text ? stops_in(*text) : std::nullopt;
  if (stops) {
    return *stops;
  }
  const Reason damaged{Errc::invalid_value, "state_damaged"};
  const auto why = text ? refuse(damaged, file_.path().string(), "is damaged") : text.error();
  log_.write(Event::stops_lost, {{"text", to_string(why)}, {"file", file_.path().string()}});
  UserStops all;
  all.stop_all({0, logging::utc(std::chrono::system_clock::now()), 0,
                "the list of stops could not be read"});
  return all;
}

void KeptStops::keep(const UserStops& now, Then then) {
  const MutexLock lock(mutex_);
  written_ = written_ && now.revision() == now_.revision();
  now_ = now;
  if (then) {
    waiting_.push_back(std::move(then));
  }
}

void KeptStops::keep_directly(const Order& order, const std::vector<std::string>& components,
                              const UserStop& by, Then then) {
  const MutexLock lock(mutex_);
  if (!served_.contains(order)) {
    direct_[order] = {components, by};
    written_ = false;
  }
  waiting_.push_back(std::move(then));
}

void KeptStops::served(const Order& order) {
  const MutexLock lock(mutex_);
  std::erase_if(served_, [](const auto& one) { return one.expired(); });
  served_.insert(order);
  written_ = direct_.erase(order) == 0 && written_;
}

UserStops KeptStops::list() const {
  auto list = now_;
  for (const auto& [order, direct] : direct_) {
    if (direct.components.empty()) {
      list.stop_all(direct.by);
    }
    for (const auto& name : direct.components) {
      list.stop(name, direct.by);
    }
  }
  return list;
}

/// A list that the disk did not take is written again with the next change.
bool KeptStops::write() {
  std::vector<Then> waiting;
  std::optional<UserStops> list;
  {
    const MutexLock lock(mutex_);
    waiting.swap(waiting_);
    if (!std::exchange(written_, true)) {
      list = this->list();
    }
  }
  const auto done = list ? put(*list) : ok();
  if (!done) {
    const auto why = to_string(done.error());
    log_.write(Event::stops_not_saved, {{"text", why}, {"file", done.error().at}});
    const MutexLock lock(mutex_);
    written_ = false;
  }
  for (const auto& then : waiting) {
    then(done.has_value());
  }
  return done.has_value();
}

/// Where nobody ever stopped anything there is no file, so damage to it stops nothing.
Status KeptStops::put(const UserStops& list) {
  std::error_code ignored;
  const auto there = std::filesystem::symlink_status(file_.path(), ignored);
  if (std::filesystem::exists(there) || !is_empty(list)) {
    return file_.replace(text_of(list));
  }
  file_.prepare();
  return ok();
}

}  // namespace mauve::daemon
