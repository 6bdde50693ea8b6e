// SPDX-License-Identifier: LGPL-3.0-or-later
/// log.tail: the last records, and those to come.
#include <memory>
#include <optional>
#include <utility>

#include "commands/answer.h"
#include "commands/look/log_json.h"
#include "commands/model.h"
#include "monitor/watch.h"

namespace mauve::daemon {

namespace {

constexpr std::size_t kDefaultCount = 100;
constexpr std::size_t kLongestGrep = 256;

using WallTime = std::chrono::system_clock::time_point;

/// The losses since the time that the request names. Without such a time they count from the first
/// record that was found. If fewer records were found than requested, the losses of the whole log
/// count.
Json dropped_json(const Running& running, const logging::Filter& filter, std::size_t count,
                  std::size_t found, std::optional<WallTime> first) {
  const auto since = filter.since ? *filter.since : found >= count && first ? *first : WallTime();
  const auto losses = running.log.history().losses(since, filter.component);
  return {{"lost", losses.lost}, {"gone", losses.gone}};
}

Json field_json(const logging::Field::Value& value) {
  return std::visit([](const auto& content) { return Json(content); }, value);
}

Result<logging::Filter> filter_from(const Running& running, const Json& params) {
  logging::Filter filter;
  if (const auto name = text_or(params, "level"); !name.empty()) {
    const auto level = logging::level_from(name);
    if (!level) {
      return refuse({Errc::invalid_value, "not_a_choice"}, "level",
                    "'" + name.substr(0, 64) + "' is no level", "debug, info, warn or error");
    }
    filter.level = *level;
  }
  filter.text = text_or(params, "grep");
  if (filter.text.size() > kLongestGrep) {
    return refuse({Errc::limit, "text_too_long"}, "grep",
                  "is longer than " + std::to_string(kLongestGrep) + " bytes");
  }
  if (const auto since = text_or(params, "since"); !since.empty()) {
    filter.since = logging::time_from(since);
    if (!filter.since) {
      return refuse({Errc::invalid_value, "not_a_time"}, "since",
                    "'" + since.substr(0, 64) + "' is no time", "such as 2026-01-31T12:00:00Z");
    }
  }
  filter.component = text_or(params, "component");
  if (!filter.component.empty()) {
    if (const auto element = find_element(running, filter.component); !element) {
      return element.error();
    }
  }
  return filter;
}

/// One request for the last records.
struct Tail {
  logging::Filter filter;
  std::size_t count = 0;
  Instant t0 = 0;
  std::optional<Watches::FollowedLog> followed;
};

/// [answer] All that is kept takes tens of milliseconds.
Json write(const Running& running, const Tail& tail) {
  const auto found =
      tail.followed ? tail.followed->kept : running.log.history().tail(tail.count, tail.filter);
  Json records = Json::array();
  for (const auto& record : found) {
    records.push_back(record_json(record, tail.t0));
  }
  const auto first = found.empty() ? std::nullopt : std::optional(found.front().time);
  auto dropped = dropped_json(running, tail.filter, tail.count, found.size(), first);
  Json result = {{"records", std::move(records)}, {"dropped", std::move(dropped)}};
  if (tail.followed) {
    result["sub"] = tail.followed->sub;
  }
  return result;
}

}  // namespace

Json record_json(const logging::Record& record, Instant t0) {
  Json fields = Json::object();
  for (const auto& field : record.fields) {
    fields[field.name] = field_json(field.value);
  }
  return {{"seq", record.seq},
          {"t", logging::utc(record.time)},
          {"t_ns", record.monotonic_ns - t0},
          {"level", to_string(record.level)},
          {"component", record.component},
          {"event", to_string(record.event)},
          {"text", record.text},
          {"fields", std::move(fields)}};
}

void tail_log(Running& running, const CallPtr& call, Ticket /*none*/) {
  if (auto room = check_long_answers(running, *call); !room) {
    return answer(running, *call, room.error());
  }
  auto filter = filter_from(running, call->params);
  if (!filter) {
    return answer(running, *call, filter.error());
  }
  auto tail = std::make_shared<Tail>();
  tail->filter = *std::move(filter);
  tail->count = number_or(call->params, "n", kDefaultCount);
  tail->t0 = running.deployer.t0();
  if (flag(call->params, "follow")) {
    auto following = running.watches.follow_log(
        call->caller, tail->filter, tail->count,
        [t0 = tail->t0](const logging::Record& record) { return record_json(record, t0); });
    if (!following) {
      return answer(running, *call, following.error());
    }
    tail->followed = *std::move(following);
  }
  running.control.write_out(
      [&running, call, tail] { answer(running, *call, write(running, *tail)); }, asker_of(*call));
}

}  // namespace mauve::daemon
