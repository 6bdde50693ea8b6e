// SPDX-License-Identifier: LGPL-3.0-or-later
/// CSV as RFC 4180 has it: one column for each plain value, one row for each sample.
#include <array>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <string_view>

#include "cli/files.h"
#include "cli/output.h"
#include "commands/actions.h"
#include "commands/recording.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

std::string cell(const Json& value) {
  if (value.is_null()) return {};
  if (!value.is_string() && !value.is_structured()) return value.dump();
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of("\",\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string header(const std::vector<Channel>& channels) {
  std::string line = "time_s";
  for (const Channel& channel : channels) line += "," + channel.name();
  return line + "\n";
}

std::string row(const std::vector<Channel>& channels, const Sample& sample) {
  std::array<char, 32> time{};
  std::snprintf(time.data(), time.size(), "%.9f", sample.time);
  std::string line = time.data();
  for (const Channel& channel : channels) {
    line += ",";
    if (channel.address == sample.address) line += cell(channel.in(sample.value));
  }
  return line + "\n";
}

constexpr std::string_view kEndings[] = {".csv"};
constexpr OutputKind kOutput{"time_s,", kEndings};

Fault no_values(const std::string& file, bool exists) {
  return protocol::wrong_use(
      "usage_nothing_to_draw",
      exists ? "no value arrived, so the file stays as it was" : "no value arrived", file,
      "listen longer with --for; mauvectl get shows the value and its status");
}

}  // namespace

int run_record(Session& session) {
  if (const auto refused = refused_output(session, kOutput)) return session.fail(*refused);
  std::vector<Channel> channels;
  for (const std::string& address : session.arguments.all("ADDRESS")) {
    auto found = channels_of(session, address);
    if (const auto* fault = std::get_if<Fault>(&found)) return session.fail(*fault);
    const auto& its = std::get<std::vector<Channel>>(found);
    channels.insert(channels.end(), its.begin(), its.end());
  }
  const std::string file = output_file(session);
  const bool replaced = replaces_file(session);
  errno = 0;
  std::optional<NewFile> beside;
  if (!file.empty()) beside.emplace(file);
  std::ostream& out = beside ? beside->stream() : session.screen.out;
  std::uint64_t rows = 0;
  std::uint64_t gaps = 0;
  out << header(channels) << std::flush;
  if (!out.good()) return session.fail(bad_file(not_written(file)));
  Status written = ok();
  const auto fault = follow(session, session.arguments.all("ADDRESS"), [&](const Sample& sample) {
    ++(sample.value.is_null() ? gaps : rows);
    out << row(channels, sample) << std::flush;
    // The first value makes it a recording, of which a later failure leaves the values so far.
    if (beside && rows > 0 && !beside->kept() && written) written = beside->keep();
  });
  if (fault) return session.fail(*fault);
  if (!written) return session.fail(bad_file(written.error()));
  if (!out.good()) {
    return session.fail(
        bad_file(refuse({Errc::system, "file_not_written"}, file, "the file is not complete")));
  }
  if (beside && !beside->kept()) return session.fail(no_values(file, replaced));
  const std::string missing = gaps > 0 ? ", and a gap at " + counted(gaps, "empty row") : "";
  report_output(session, "recorded " + counted(rows, "value") + missing,
                {{"values", rows}, {"gaps", gaps}}, replaced);
  return 0;
}

}  // namespace mauve::ctl
