// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "log/event.h"
#include "mauve/host/version.h"
#include "protocol/trace.h"
#include "rt/process/descriptor.h"

namespace mauve::daemon {

namespace {

using protocol::Json;

using protocol::kMostRecords;

protocol::TraceComponent on_wire(const TracedComponent& component) {
  protocol::TraceComponent wire;
  wire.name = component.name;
  wire.type = component.type;
  wire.core = component.core;
  wire.change = static_cast<std::int64_t>(component.change);
  wire.initial = component.initial;
  wire.priority = component.priority;
  wire.cpus.assign(component.cpus.begin(), component.cpus.end());
  wire.scheduled = component.scheduled;
  wire.timed = component.timed;
  wire.realtime = component.realtime;
  wire.period = component.period.count();
  wire.offset = component.offset.count();
  wire.deadline = component.deadline.count();
  wire.budget = component.budget.count();
  if (component.bound > Duration{0}) {
    wire.bound = component.bound.count();
    wire.measured = component.measured;
  }
  for (const auto& state : component.states) {
    wire.states.push_back({state.name, state.waits, state.wait.count()});
  }
  return wire;
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
    header.components.push_back(on_wire(component));
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

/// A FIFO or link that a user puts in place of the file does not block the reader: it reads regular
/// files only.
std::string part_of(const std::filesystem::path& file, std::size_t from, std::size_t most) {
  const rt::Descriptor fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW));
  struct stat status {};
  if (!fd || ::fstat(fd.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return {};
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  std::string text(from < size ? std::min(most, size - from) : 0, '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const auto got =
        ::pread(fd.get(), text.data() + done, text.size() - done, static_cast<off_t>(from + done));
    if (got <= 0) {
      break;
    }
    done += static_cast<std::size_t>(got);
  }
  text.resize(done);
  return text;
}

/// A line that is longer than a page is damage, and the end.
Result<Json> page_of(const std::filesystem::path& file, std::size_t from, std::size_t count) {
  const auto head = part_of(file, 0, kLongestHeader);
  const auto first = head.find('\n');
  auto header = first == std::string::npos ? Result<Json>(Json())
                                           : protocol::parse_json(head.substr(0, first));
  if (!header || !header->is_object()) {
    return refuse({Errc::invalid_value, "recording_damaged"}, file.filename().string(),
                  "cannot be read", "mauvectl trace list shows what is there");
  }
  std::size_t next = std::max(from, first + 1);
  const auto text = part_of(file, next, 2 * kMostBytes);
  Json records = Json::array();
  bool end = true;
  for (std::size_t at = 0, line = 0; end && at < text.size() && text[at] != '{'; at = line + 1) {
    line = text.find('\n', at);
    if (line == std::string::npos) {
      break;
    }
    if (records.size() >= std::min(count, kMostRecords) || at >= kMostBytes) {
      end = false;
      break;
    }
    next += line + 1 - at;
    if (auto record = protocol::parse_json(text.substr(at, line - at))) {
      records.push_back(*std::move(record));
    }
  }
  return Json{{"header", *std::move(header)},
              {"records", std::move(records)},
              {"next", next},
              {"end", end}};
}

}  // namespace mauve::daemon
