// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cli/files.h"
#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

constexpr std::size_t kFewest = 3;  // members of a record
constexpr std::size_t kMost = 6;

/// 36 years in ns: sums and differences of a few such numbers fit as well.
constexpr std::int64_t kLargest = std::int64_t{1} << 60U;

std::optional<std::int64_t> integer(const Json& value) {
  if (!value.is_number_integer()) return std::nullopt;
  const auto limit = static_cast<std::uint64_t>(kLargest);
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > limit) return std::nullopt;
  const auto number = value.get<std::int64_t>();
  if (number < -kLargest || number > kLargest) return std::nullopt;
  return number;
}

std::int64_t integer_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? 0 : integer(*found).value_or(0);
}

State state_of(const Json& json) {
  return {text_in(json, "name"), text_in(json, "kind") == "synchronization",
          integer_in(json, "wait_ns")};
}

Component component_of(const Json& json) {
  Component component;
  component.name = text_in(json, "name");
  component.type = text_in(json, "type");
  component.core = text_in(json, "core");
  component.initial = text_in(json, "initial");
  component.priority = integer_in(json, "priority");
  component.realtime = json.value("realtime", Json()) == true;
  component.period = std::max<std::int64_t>(0, integer_in(json, "period_ns"));
  component.offset = integer_in(json, "offset_ns");
  component.deadline = integer_in(json, "deadline_ns");
  component.budget = integer_in(json, "budget_ns");
  if (json.contains("change")) component.change = integer(json["change"]);
  if (json.contains("scheduled_ns")) component.scheduled = integer(json["scheduled_ns"]);
  if (json.contains("timed_ns")) component.timed = integer(json["timed_ns"]);
  if (json.contains("bound_ns")) component.bound = integer(json["bound_ns"]);
  component.measured = json.value("bound_measured", Json()) == true;
  for (const Json& cpu : list_in(json, "cpus")) {
    if (const auto number = integer(cpu)) component.cpus.push_back(*number);
  }
  for (const Json& state : list_in(json, "states")) {
    if (state.is_object()) component.states.push_back(state_of(state));
  }
  return component;
}

/// Why the members of a record are none; empty: they are.
std::string read_members(const Json& json, Record& record) {
  const auto time = integer(json[0]);
  if (!time) return "its time is no whole number of nanoseconds";
  record.time = *time;
  if (json.size() > 4) {
    const auto a = integer(json[4]);
    if (!a) return "its fifth member is no whole number";
    record.a = *a;
  }
  const bool user = record.event == Event::user;
  double value = user && json.size() > 5 ? std::nan("") : 0.0;
  if (json.size() > 5 && user && json[5].is_number()) value = json[5].get<double>();
  if (user) {
    record.b = std::bit_cast<std::int64_t>(value);
  } else if (json.size() > 5) {
    const auto b = integer(json[5]);
    if (!b) return "its sixth member is no whole number";
    record.b = *b;
  }
  return {};
}

}  // namespace

Status Builder::header(const Json& header) {
  const auto version =
      header.is_object() ? integer(header.value("mauve_trace", Json())) : std::nullopt;
  if (!version) {
    return refuse({Errc::invalid_value, "not_a_trace"}, {}, "this is no trace of mauve",
                  "mauvectl trace dump writes one");
  }
  if (*version != protocol::kTraceFormat) {
    return refuse({Errc::unsupported, "trace_other_version"}, {},
                  "this is a trace of version " + std::to_string(*version) +
                      ", and this mauvectl reads version " + std::to_string(protocol::kTraceFormat),
                  "use the mauvectl that belongs to the mauved that wrote it");
  }
  Header& into = trace_.header;
  into.mauved = text_in(header, "mauved");
  into.architecture = text_in(header, "architecture");
  into.boot = text_in(header, "boot");
  into.written = text_in(header, "t");
  into.t0 = integer_in(header, "t0_ns");
  into.from = integer_in(header, "from");
  into.to = integer_in(header, "to");
  into.why = text_in(header, "why");
  into.lost = static_cast<std::uint64_t>(std::max<std::int64_t>(0, integer_in(header, "lost")));
  into.probed = !header.contains("probe") || header["probe"] == true;
  for (const Json& component : list_in(header, "components")) {
    if (component.is_object()) into.components.push_back(component_of(component));
  }
  for (const Json& resource : list_in(header, "resources")) {
    if (resource.is_string()) into.resources.push_back(resource.get<std::string>());
  }
  return ok();
}

void Builder::record(const Json& record, std::uint64_t line) {
  if (!record.is_array() || record.size() < kFewest || record.size() > kMost) {
    return broken(line, "it is no list of three to six members");
  }
  const std::size_t texts = std::min<std::size_t>(record.size(), 4);
  for (std::size_t i = 1; i < texts; ++i) {
    if (!record[i].is_string()) {
      return broken(line, "its thread, event and name are not all texts");
    }
  }
  const auto event = event_named(record[2].get_ref<const std::string&>());
  if (!event) {
    ++trace_.reading.unknown;
    return;
  }
  Record made;
  made.event = *event;
  if (std::string reason = read_members(record, made); !reason.empty()) {
    return broken(line, std::move(reason));
  }
  made.line = static_cast<std::uint32_t>(line);
  made.thread = trace_.intern(record[1].get_ref<const std::string&>());
  made.name = trace_.intern(texts > 3 ? std::string_view(record[3].get_ref<const std::string&>())
                                      : std::string_view{});
  trace_.records.push_back(made);
}

void Builder::broken(std::uint64_t line, std::string reason) {
  if (trace_.reading.broken++ > 0) return;
  trace_.reading.first_broken = line;
  trace_.reading.first_reason = std::move(reason);
}

void Reader::feed(std::string_view bytes) {
  while (!bytes.empty() && refused_) {
    const auto end = bytes.find('\n');
    const auto piece = bytes.substr(0, end);
    too_long_ = too_long_ || partial_.size() + piece.size() > kLongestLine;
    if (too_long_) {
      partial_.clear();
    } else {
      partial_ += piece;
    }
    if (end == std::string_view::npos) return;
    line();
    bytes.remove_prefix(end + 1);
  }
}

void Reader::line() {
  const std::uint64_t number = number_++;
  const bool too_long = std::exchange(too_long_, false);
  const std::string text = std::exchange(partial_, {});
  if (too_long && number > 1) return builder_.broken(number, "it is too long");
  if (text.empty() && number > 1) return;
  const auto json = protocol::parse_json(text);
  if (number == 1) {
    refused_ = builder_.header(json ? *json : Json());
  } else if (!json) {
    builder_.broken(number, json.error().message);
  } else if (ended_) {
    builder_.broken(number, "it stands behind the end");
  } else if (json->is_object() && json->value("end", Json()) == true) {
    ended_ = true;
    builder_.complete();
  } else {
    builder_.record(*json, number);
  }
}

Result<Trace> Reader::finish() {
  // A file that was cut off may end within a line, which needs no report each time.
  const bool whole = !partial_.empty() && protocol::parse_json(partial_).has_value();
  if (whole || number_ == 1) line();
  if (!refused_) return refused_.error();
  return builder_.take();
}

Result<Trace> read_file(const std::string& path) {
  auto stream = open_to_read(path);
  if (!stream) return stream.error();
  Reader reader;
  std::array<char, 65536> piece{};
  while (stream->read(piece.data(), piece.size()), stream->gcount() > 0) {
    reader.feed({piece.data(), static_cast<std::size_t>(stream->gcount())});
  }
  auto trace = reader.finish();
  if (!trace) trace.error().at = path;
  return trace;
}

std::string record_line(const Trace& trace, const Record& record) {
  const TraceRecord plain{record.time, record.event, 0, 0, record.a, record.b};
  return protocol::to_line(protocol::trace_record(
             plain, trace.text(record.thread), to_string(record.event), trace.text(record.name))) +
         "\n";
}

void write(const Trace& trace, std::ostream& out) {
  out << protocol::to_line(protocol::to_json(trace.header)) << "\n";
  for (const Record& record : trace.records) out << record_line(trace, record);
  out << protocol::to_line(protocol::trace_end(trace.records.size(), trace.header.lost)) << "\n";
}

}  // namespace mauve::ctl::mtrace
