// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/file.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <fstream>
#include <utility>

#include "log/event.h"
#include "mauve/version.h"

namespace mauve::daemon {

namespace {

using protocol::Json;

Json component_json(const TracedComponent& component) {
  Json states = Json::array();
  for (const auto& state : component.states) {
    Json row = {{"name", state.name}, {"kind", state.waits ? "synchronization" : "execution"}};
    if (state.waits) {
      row["wait_ns"] = state.wait.count();
    }
    states.push_back(std::move(row));
  }
  Json json = {{"name", component.name},
               {"type", component.type},
               {"core", component.core},
               {"priority", component.priority},
               {"cpus", component.cpus},
               {"realtime", component.realtime},
               {"period_ns", component.period.count()},
               {"offset_ns", component.offset.count()},
               {"deadline_ns", component.deadline.count()},
               {"budget_ns", component.budget.count()},
               {"states", std::move(states)},
               {"initial", component.initial}};
  if (component.bound > Duration{0}) {
    json["bound_ns"] = component.bound.count();
  }
  return json;
}

Json last_line(std::size_t records, std::int64_t lost) {
  return {{"end", true}, {"records", records}, {"lost", lost}};
}

}  // namespace

Json header_of(const Recording& recording, const std::string& boot) {
  Json components = Json::array();
  for (const auto& component : recording.about.components) {
    components.push_back(component_json(component));
  }
  return {{"mauve_trace", kTraceFormat},
          {"mauved", std::string(kVersion)},
          {"architecture", recording.about.architecture},
          {"boot", boot},
          {"t", logging::utc(std::chrono::system_clock::now())},
          {"t0_ns", recording.about.t0},
          {"from", recording.from},
          {"to", recording.to},
          {"why", recording.why},
          {"lost", recording.lost},
          {"probe", recording.probed},
          {"components", std::move(components)},
          {"resources", recording.about.resources}};
}

Json to_json(const TraceRecord& record) {
  Json json = Json::array({record.time, trace_name(record.thread), to_string(record.kind)});
  const bool number = record.kind == TraceKind::user;
  const bool b = number || record.b != 0;
  if (record.name != 0 || record.a != 0 || b) {
    json.push_back(trace_name(record.name));
  }
  if (record.a != 0 || b) {
    json.push_back(record.a);
  }
  if (b) {
    json.push_back(number ? Json(std::bit_cast<double>(record.b)) : Json(record.b));
  }
  return json;
}

std::string to_text(const Recording& recording, const Json& header) {
  std::string text = protocol::to_line(header) + "\n";
  for (const auto& record : recording.records) {
    text += protocol::to_line(to_json(record)) + "\n";
  }
  return text + protocol::to_line(last_line(recording.records.size(), recording.lost)) + "\n";
}

Json page_of(const Recording& recording, std::size_t from, std::size_t count) {
  Json records = Json::array();
  const std::size_t total = recording.records.size();
  std::size_t next = std::min(from, total);
  const std::size_t until = std::min(total, next + std::min(count, kMostRecords));
  for (std::size_t bytes = 0; next < until && bytes < kMostBytes; ++next) {
    const auto& record = recording.records[next];
    bytes += 80 + trace_name(record.thread).size() + trace_name(record.name).size();
    records.push_back(to_json(record));
  }
  return {{"records", std::move(records)}, {"next", next}, {"end", next == total}};
}

Result<Json> page_of(const std::filesystem::path& file, std::size_t from, std::size_t count) {
  std::ifstream stream(file);
  std::string line;
  auto header = std::getline(stream, line) ? protocol::parse_json(line) : Result<Json>(Json());
  if (!header || !header->is_object()) {
    return refuse(Errc::invalid_value, file.filename().string(), "cannot be read",
                  "mauvectl trace list shows what is there");
  }
  const std::size_t first = line.size() + 1;
  std::size_t next = std::max(from, first);
  stream.seekg(static_cast<std::streamoff>(next));
  Json records = Json::array();
  bool end = true;
  for (std::size_t bytes = 0; std::getline(stream, line) && !line.starts_with("{");) {
    if (records.size() >= std::min(count, kMostRecords) || bytes >= kMostBytes) {
      end = false;
      break;
    }
    bytes += line.size();
    next += line.size() + 1;
    if (auto record = protocol::parse_json(line)) {
      records.push_back(*std::move(record));
    }
  }
  return Json{{"header", *std::move(header)},
              {"records", std::move(records)},
              {"next", next},
              {"end", end}};
}

}  // namespace mauve::daemon
