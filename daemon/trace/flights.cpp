// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/flights.h"

#include "base/thread_role.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <optional>
#include <system_error>

#include "base/mutex.h"
#include "state/durable.h"
#include "trace/file.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using protocol::Json;

constexpr const char* kPrefix = "flight-";
constexpr const char* kExtension = ".mtrace";

/// Names of components are plain; nothing else gets into the name of a file.
std::string for_file(std::string text) {
  std::erase_if(text,
                [](char c) { return !(std::isalnum(static_cast<unsigned char>(c)) || c == '_'); });
  return text.substr(0, 64);
}

/// The last line of a file of this size.
std::string last_line_of(const std::filesystem::path& file, std::uintmax_t size) {
  constexpr std::uintmax_t kLongest = 200;
  auto text = part_of(file, size - std::min(size, kLongest), kLongest);
  while (text.ends_with('\n')) {
    text.pop_back();
  }
  return text.substr(text.rfind('\n') + 1);
}

std::string text_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

/// The flight that the first and the last line of the file describe. Nothing is returned for a
/// damaged file and for one that mauved did not write.
std::optional<Flight> look_at(const std::filesystem::path& file) {
  constexpr unsigned long long kMostFlights = 1'000'000'000'000;
  Flight flight;
  flight.name = file.stem().string();
  unsigned long long number = 0;
  const bool named = std::sscanf(flight.name.c_str(), "flight-%llu-", &number) == 1;
  const auto head = named && number < kMostFlights ? part_of(file, 0, kLongestHeader) : "";
  const auto header = protocol::parse_json(head.substr(0, head.find('\n')));
  if (!header || !header->is_object()) {
    return std::nullopt;
  }
  flight.number = number;
  flight.why = text_in(*header, "why");
  flight.time = text_in(*header, "t");
  std::error_code gone;
  const auto size = std::filesystem::file_size(file, gone);
  const auto last = protocol::parse_json(last_line_of(file, gone ? 0 : size));
  if (last && last->is_object() && last->contains("records") &&
      (*last)["records"].is_number_unsigned()) {
    flight.records = (*last)["records"].get<std::size_t>();
  }
  return flight;
}

}  // namespace

Flights::Flights(std::string directory, logging::Log& log)
    : directory_(std::move(directory)), log_(log) {
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(directory_, failed)) {
    const auto& file = entry.path();
    if (file.extension() != kExtension || !file.filename().string().starts_with(kPrefix)) {
      continue;
    }
    if (auto flight = look_at(file)) {
      flights_.push_back(*std::move(flight));
    } else {
      log_.write(Event::flight_not_kept,
                 {{"text", file.string() + ": is no recording, or damaged; it is not listed"}});
    }
  }
  std::sort(flights_.begin(), flights_.end(),
            [](const Flight& a, const Flight& b) { return a.number < b.number; });
  if (!flights_.empty()) {
    next_ = flights_.back().number + 1;
  }
}

void Flights::write(const Recording& recording, const std::string& word,
                    const std::string& component, const std::string& boot) {
  MAUVE_ON_THREAD(disk);
  const Json header = header_of(recording, boot);
  Flight flight;
  {
    const MutexLock lock(mutex_);
    flight.number = next_++;
  }
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%04llu",
                static_cast<unsigned long long>(flight.number));
  flight.name = kPrefix + std::string(number.data()) + "-" + for_file(word) +
                (component.empty() ? "" : "-" + for_file(component));
  flight.why = recording.why;
  flight.time = header.value("t", "");
  flight.records = recording.records.size();
  const auto file = directory_ / (flight.name + kExtension);
  const auto written = replace_file(file, to_text(recording, header));
  if (!written) {
    if (!broken_) {
      log_.write(Event::flight_not_kept, {{"text", to_string(written.error())}});
    }
    broken_ = true;
    return;
  }
  broken_ = false;
  {
    const MutexLock lock(mutex_);
    flights_.push_back(flight);
  }
  drop_oldest();
  log_.write(Event::flight_recorded,
             {{"component", component}, {"why", flight.why}, {"recording", flight.name}});
}

/// While more than kKeptOfMisses recordings of a missed release are kept, the oldest of them is the
/// least wanted. So a machine that is often late does not push out the recordings of faults, and
/// faults do not push out the last ones of misses.
std::vector<Flight>::iterator Flights::least_wanted() {
  const auto of_miss = [](const Flight& one) { return one.why.starts_with("missed"); };
  const auto misses = std::count_if(flights_.begin(), flights_.end(), of_miss);
  const bool many = static_cast<std::size_t>(misses) > kKeptOfMisses;
  return std::find_if(flights_.begin(), flights_.end(),
                      [&](const Flight& one) { return of_miss(one) == many; });
}

void Flights::drop_oldest() {
  const MutexLock lock(mutex_);
  while (flights_.size() > kKept) {
    const auto oldest = least_wanted();
    std::error_code ignored;
    std::filesystem::remove(directory_ / (oldest->name + kExtension), ignored);
    flights_.erase(oldest);
  }
}

std::vector<Flight> Flights::list() const {
  const MutexLock lock(mutex_);
  return flights_;
}

Result<std::filesystem::path> Flights::find(const std::string& name) const {
  const MutexLock lock(mutex_);
  const bool known = std::any_of(flights_.begin(), flights_.end(),
                                 [&](const Flight& one) { return one.name == name; });
  if (known) {
    return directory_ / (name + kExtension);
  }
  return refuse({Errc::unknown_name, "unknown_recording"}, name.substr(0, 64),
                "there is no recording of this name", "mauvectl trace list shows what is there");
}

}  // namespace mauve::daemon
