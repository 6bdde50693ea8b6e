// SPDX-License-Identifier: LGPL-3.0-or-later
#include <sys/uio.h>
#include <systemd/sd-journal.h>

#include <array>
#include <cctype>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "log/sink.h"

namespace mauve::logging {

namespace {

/// syslog(3) priorities.
int priority(Level level) {
  constexpr std::array<int, 4> kPriorities = {7, 6, 4, 3};
  return kPriorities.at(static_cast<std::size_t>(level));
}

std::string field_name(std::string_view name) {
  std::string out = "MAUVE_";
  for (const char c : name) {
    out += std::isalnum(static_cast<unsigned char>(c)) != 0
               ? static_cast<char>(std::toupper(static_cast<unsigned char>(c)))
               : '_';
  }
  return out;
}

std::vector<std::string> entries(const Record& record) {
  std::vector<std::string> out = {
      "MESSAGE=" + (record.component.empty() ? "" : record.component + ": ") + record.text,
      fmt::format("PRIORITY={}", priority(record.level)),
      "MESSAGE_ID=" + message_id(record.event),
      "SYSLOG_IDENTIFIER=mauved",
      fmt::format("MAUVE_EVENT={}", to_string(record.event)),
      fmt::format("MAUVE_SEQ={}", record.seq),
      fmt::format("MAUVE_MONOTONIC_NS={}", record.monotonic_ns),
  };
  if (!record.component.empty()) {
    out.push_back("MAUVE_COMPONENT=" + record.component);
  }
  for (const auto& field : record.fields) {
    out.push_back(field_name(field.name) + "=" + to_string(field.value));
  }
  return out;
}

class JournalSink final : public Sink {
 public:
  Status write(const Record& record) override {
    // sd_journal_sendv() calls it a success when there is no journal.
    if (!journal_answers()) {
      return refuse({Errc::system, "log_not_written"}, "the journal", "no journal answers",
                    "see to systemd-journald");
    }
    auto texts = entries(record);
    std::vector<iovec> parts;
    parts.reserve(texts.size());
    for (auto& text : texts) {
      parts.push_back({text.data(), text.size()});
    }
    const int rc = sd_journal_sendv(parts.data(), static_cast<int>(parts.size()));
    if (rc < 0) {
      return refuse({Errc::system, "log_not_written"}, "the journal", std::strerror(-rc));
    }
    return ok();
  }
};

}  // namespace

std::unique_ptr<Sink> journal_sink() { return std::make_unique<JournalSink>(); }

}  // namespace mauve::logging
