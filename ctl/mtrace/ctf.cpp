// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/ctf.h"

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <type_traits>
#include <vector>

#include "cli/files.h"

namespace mauve::ctl::mtrace {
namespace {

constexpr std::uint32_t kMagic = 0xC1FC1FC1;

/// Clocks of CTF do not run below zero, and events before T0 may be in the trace.
std::int64_t clock_of_t0(const Trace& trace) {
  return std::max(trace.header.t0, -std::min<std::int64_t>(0, trace.first_time()));
}

/// The text of a TSDL string.
std::string tsdl_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const bool plain = static_cast<unsigned char>(c) >= 0x20;
    if (c == '"' || c == '\\') result += '\\';
    if (plain) result += c;
  }
  return result + "\"";
}

std::string event_type(Event event) {
  const EventWords& words = words_of(event);
  std::string fields;
  const auto add = [&](std::string_view type, std::string_view name) {
    if (!name.empty()) fields += " " + std::string(type) + " " + std::string(name) + ";";
  };
  add("string", words.name);
  add("i64", words.a);
  add(event == Event::user ? "f64" : "i64", words.b);
  return "event {\n  name = \"" + std::string(to_string(event)) +
         "\";\n  id = " + std::to_string(static_cast<int>(event)) +
         ";\n  stream_id = 0;\n  fields := struct {" + fields + " };\n};\n";
}

/// Bytes, little endian.
class Bytes {
 public:
  template <typename T>
  void number(T value) {
    const auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      text.push_back(static_cast<char>(bits >> (8 * i) & 0xFFU));
    }
  }
  /// Up to a NUL within, where there is one.
  void string(const std::string& value) { text.append(value.c_str()).push_back('\0'); }

  std::string text;
};

void append(Bytes& bytes, const Trace& trace, const Record& record, std::int64_t t0) {
  const EventWords& words = words_of(record.event);
  bytes.number(static_cast<std::uint8_t>(record.event));
  bytes.number(static_cast<std::uint64_t>(t0 + record.time));
  bytes.string(trace.text(record.thread));
  if (!words.name.empty()) bytes.string(trace.text(record.name));
  if (!words.a.empty()) bytes.number(record.a);
  if (!words.b.empty()) bytes.number(record.b);
}

}  // namespace

std::string ctf_metadata(const Trace& trace) {
  std::string text =
      "/* CTF 1.8 */\n"
      "typealias integer { size = 8; align = 8; signed = false; } := u8;\n"
      "typealias integer { size = 32; align = 8; signed = false; } := u32;\n"
      "typealias integer { size = 64; align = 8; signed = false; } := u64;\n"
      "typealias integer { size = 64; align = 8; signed = true; } := i64;\n"
      "typealias floating_point { exp_dig = 11; mant_dig = 53; align = 8; } := f64;\n"
      "trace {\n  major = 1;\n  minor = 8;\n  byte_order = le;\n"
      "  packet.header := struct { u32 magic; u32 stream_id; };\n};\n";
  const Header& header = trace.header;
  text += "env {\n  domain = \"mauve\";\n  mauved = " + tsdl_text(header.mauved) +
          ";\n  architecture = " + tsdl_text(header.architecture) +
          ";\n  why = " + tsdl_text(header.why) +
          ";\n  t0_ns = " + std::to_string(clock_of_t0(trace)) + ";\n};\n";
  text +=
      "clock {\n  name = monotonic;\n  description = \"CLOCK_MONOTONIC\";\n  freq = 1000000000;\n"
      "};\n"
      "typealias integer {\n  size = 64; align = 8; signed = false; map = "
      "clock.monotonic.value;\n} := u64_time;\n"
      "stream {\n  id = 0;\n"
      "  packet.context := struct { u64_time timestamp_begin; u64_time timestamp_end; "
      "u64 content_size; u64 packet_size; };\n"
      "  event.header := struct { u8 id; u64_time timestamp; };\n"
      "  event.context := struct { string thread; };\n};\n";
  for (std::size_t id = 0; id < event_words().size(); ++id) {
    text += event_type(static_cast<Event>(id));
  }
  return text;
}

std::string ctf_stream(const Trace& trace) {
  std::vector<const Record*> order;
  order.reserve(trace.records.size());
  for (const Record& record : trace.records) order.push_back(&record);
  std::stable_sort(order.begin(), order.end(),
                   [](const Record* x, const Record* y) { return x->time < y->time; });
  const std::int64_t t0 = clock_of_t0(trace);
  Bytes events;
  for (const Record* record : order) append(events, trace, *record, t0);
  Bytes packet;
  packet.number(kMagic);
  packet.number(std::uint32_t{0});
  packet.number(static_cast<std::uint64_t>(t0 + trace.first_time()));
  packet.number(static_cast<std::uint64_t>(t0 + trace.last_time()));
  const std::uint64_t size = packet.text.size() + 2 * sizeof(std::uint64_t) + events.text.size();
  packet.number(size * 8);
  packet.number(size * 8);
  return packet.text + events.text;
}

Status write_ctf(const Trace& trace, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return refuse({Errc::system, "file_not_written"}, folder,
                  "the folder cannot be made: " + error.message());
  }
  const std::filesystem::path place(folder);
  if (Status done =
          write_file(place / "metadata", [&](std::ostream& out) { out << ctf_metadata(trace); });
      !done) {
    return done;
  }
  return write_file(place / "stream", [&](std::ostream& out) { out << ctf_stream(trace); });
}

}  // namespace mauve::ctl::mtrace
