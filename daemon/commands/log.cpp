// SPDX-License-Identifier: LGPL-3.0-or-later
/// log.tail: the last records, and those to come.
#include "commands/answer.h"
#include "commands/model.h"
#include "watch.h"

namespace mauve::daemon {

namespace {

constexpr std::size_t kDefaultCount = 100;

Json field_json(const logging::Field::Value& value) {
  return std::visit([](const auto& content) { return Json(content); }, value);
}

/// The members that the wire promises.
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

Result<logging::Filter> filter_from(const Running& running, const Json& params) {
  logging::Filter filter;
  if (const auto name = text_or(params, "level"); !name.empty()) {
    const auto level = logging::level_from(name);
    if (!level) {
      return refuse(Errc::invalid_value, "level", "'" + name.substr(0, 64) + "' is no level",
                    "debug, info, warn or error");
    }
    filter.level = *level;
  }
  filter.component = text_or(params, "component");
  if (!filter.component.empty()) {
    if (const auto element = find_element(running, filter.component); !element) {
      return element.error();
    }
  }
  return filter;
}

}  // namespace

Result<Json> tail_log(Running& running, const Call& call) {
  auto filter = filter_from(running, call.params);
  if (!filter) {
    return filter.error();
  }
  const auto wanted = call.params.find("n");
  const auto count = wanted == call.params.end() ? kDefaultCount : wanted->get<std::size_t>();
  const auto t0 = running.deployer.t0();
  Json records = Json::array();
  if (!flag(call.params, "follow")) {
    for (const auto& record : running.log.history().tail(count, *filter)) {
      records.push_back(record_json(record, t0));
    }
    return Json{{"records", std::move(records)}};
  }
  const auto sub = running.watches.follow_log(
      call.caller, *filter, count,
      [&](const logging::Record& record) { records.push_back(record_json(record, t0)); },
      [t0](const logging::Record& record) { return record_json(record, t0); });
  if (!sub) {
    return sub.error();
  }
  return Json{{"records", std::move(records)}, {"sub", *sub}};
}

}  // namespace mauve::daemon
