// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/file.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <utility>

#include "log/event.h"
#include "mauve/version.h"
#include "protocol/trace.h"

namespace mauve::daemon {

namespace {

using protocol::Json;

using protocol::kMostRecords;

protocol::TraceComponent told(const TracedComponent& component) {
  protocol::TraceComponent told;
  told.name = component.name;
  told.type = component.type;
  told.core = component.core;
  told.initial = component.initial;
  told.priority = component.priority;
  told.cpus.assign(component.cpus.begin(), component.cpus.end());
  told.realtime = component.realtime;
  told.period = component.period.count();
  told.offset = component.offset.count();
  told.deadline = component.deadline.count();
  told.budget = component.budget.count();
  if (component.bound > Duration{0}) {
    told.bound = component.bound.count();
  }
  for (const auto& state : component.states) {
    told.states.push_back({state.name, state.waits, state.wait.count()});
  }
  return told;
}

std::uint64_t lost_of(const Recording& recording) {
  return static_cast<std::uint64_t>(recording.lost);
}

}  // namespace

Json header_of(const Recording& recording, const std::string& boot) {
  protocol::TraceHeader header;
  header.mauved = std::string(kVersion);
  header.architecture = recording.about.architecture;
  header.boot = boot;
  header.written = logging::utc(std::chrono::system_clock::now());
  header.t0 = recording.about.t0;
  header.from = recording.from;
  header.to = recording.to;
  header.why = recording.why;
  header.lost = lost_of(recording);
  header.probed = recording.probed;
  for (const auto& component : recording.about.components) {
    header.components.push_back(told(component));
  }
  header.resources = recording.about.resources;
  return protocol::to_json(header);
}

Json to_json(const TraceRecord& record) {
  return protocol::trace_record(record, trace_name(record.thread), to_string(record.kind),
                                trace_name(record.name));
}

std::string to_text(const Recording& recording, const Json& header) {
  std::string text = protocol::to_line(header) + "\n";
  for (const auto& record : recording.records) {
    text += protocol::to_line(to_json(record)) + "\n";
  }
  return text +
         protocol::to_line(protocol::trace_end(recording.records.size(), lost_of(recording))) +
         "\n";
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
