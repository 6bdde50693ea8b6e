// SPDX-License-Identifier: LGPL-3.0-or-later
/// CSV as RFC 4180 has it: one column for each plain value, one row for each sample.
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>

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

}  // namespace

int run_record(Session& session) {
  std::vector<Channel> channels;
  for (const std::string& address : session.arguments.all("ADDRESS")) {
    auto found = channels_of(session, address);
    if (const auto* fault = std::get_if<Fault>(&found)) return session.fail(*fault);
    const auto& its = std::get<std::vector<Channel>>(found);
    channels.insert(channels.end(), its.begin(), its.end());
  }
  const std::string file = session.arguments.one("-o,--output");
  const bool replaced = replaces_file(session);
  std::ofstream stream;
  errno = 0;
  if (!file.empty()) stream.open(file, std::ios::binary);
  std::ostream& out = file.empty() ? session.screen.out : stream;
  std::uint64_t rows = 0;
  std::uint64_t gaps = 0;
  out << header(channels) << std::flush;
  if (!out.good()) return session.fail(bad_file(not_written(file)));
  const auto fault = follow(session, session.arguments.all("ADDRESS"), [&](const Sample& sample) {
    ++(sample.value.is_null() ? gaps : rows);
    out << row(channels, sample) << std::flush;
  });
  if (fault) return session.fail(*fault);
  if (!out.good()) {
    return session.fail(
        bad_file(refuse({Errc::system, "file_not_written"}, file, "the file is not complete")));
  }
  const std::string missing = gaps > 0 ? ", and a gap at " + counted(gaps, "empty row") : "";
  report_output(session, "recorded " + counted(rows, "value") + missing,
                {{"values", rows}, {"gaps", gaps}}, replaced);
  return 0;
}

}  // namespace mauve::ctl
