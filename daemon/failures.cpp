// SPDX-License-Identifier: LGPL-3.0-or-later
#include "failures.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mauve::daemon {

namespace {

using logging::Event;

/// The rings are emptied 50 times a second.
constexpr std::int64_t kLogNeeds = 200'000'000;
/// A failure is noticed later than it happens; longer ago is another one.
constexpr std::int64_t kNoticedWithin = 2'000'000'000;

std::string field(const logging::Record& record, std::string_view name) {
  const auto found = std::find_if(record.fields.begin(), record.fields.end(),
                                  [&](const auto& one) { return one.name == name; });
  return found == record.fields.end() ? std::string() : logging::to_string(found->value);
}

}  // namespace

std::string_view to_string(Reaction reaction) {
  constexpr std::array<std::string_view, 4> kNames = {"parked", "rolled_back", "fell_back",
                                                      "restarted"};
  return kNames.at(static_cast<std::size_t>(reaction));
}

void Failures::runs(const std::string& component, CoreBuild core) {
  entries_[component].core = std::move(core);
}

CoreBuild Failures::running(const std::string& component) const {
  const auto found = entries_.find(component);
  return found == entries_.end() ? CoreBuild() : found->second.core;
}

void Failures::changed(const std::vector<std::string>& components, const Attempt& attempt) {
  for (const auto& component : components) {
    entries_[component].change = attempt;
  }
}

const Attempt* Failures::last_change(const std::string& component) const {
  const auto found = entries_.find(component);
  return found == entries_.end() || !found->second.change ? nullptr : &*found->second.change;
}

void Failures::note(const std::string& component, Failure failure) {
  auto& entry = entries_[component];
  failure.times = entry.failure ? entry.failure->times + 1 : 1;
  failure.change = entry.change;
  entry.failure = std::move(failure);
  entry.complete = false;
}

bool Failures::parks(const std::string& component, std::uint64_t releases) {
  return std::exchange(entries_[component].parked_after, releases) != releases;
}

void Failures::ask_log(const logging::History& history, std::int64_t now) {
  for (auto& [component, entry] : entries_) {
    if (!entry.complete && now - entry.failure->monotonic_ns >= kLogNeeds) {
      complete(component, entry, history);
    }
  }
}

const Failure* Failures::find(const std::string& component, const logging::History& history) {
  const auto found = entries_.find(component);
  if (found == entries_.end() || !found->second.failure) {
    return nullptr;
  }
  if (!found->second.complete) {
    complete(component, found->second, history);
    found->second.complete = false;  // the log may know more soon
  }
  return &*found->second.failure;
}

/// What the failing thread itself said is nearer to the truth than when it was noticed.
void Failures::complete(const std::string& component, Entry& entry,
                        const logging::History& history) {
  entry.complete = true;
  auto& failure = *entry.failure;
  logging::Filter filter;
  filter.component = component;
  auto records = history.tail(4 * kRecords, filter);
  const auto says = std::find_if(records.rbegin(), records.rend(), [&](const auto& record) {
    return record.event == Event::component_faulted &&
           record.monotonic_ns <= failure.monotonic_ns + kLogNeeds &&
           record.monotonic_ns + kNoticedWithin >= failure.monotonic_ns;
  });
  if (says != records.rend()) {
    failure.time = logging::utc(says->time);
    failure.monotonic_ns = says->monotonic_ns;
    failure.fsm_state = field(*says, "state");
    if (auto cause = field(*says, "cause"); !cause.empty()) {
      failure.cause = std::move(cause);
    }
  }
  std::erase_if(records,
                [&](const auto& record) { return record.monotonic_ns > failure.monotonic_ns; });
  if (records.size() > kRecords) {
    records.erase(records.begin(), records.end() - static_cast<std::ptrdiff_t>(kRecords));
  }
  if (!records.empty() || failure.records.empty()) {
    failure.records = std::move(records);
  }
}

void Failures::keep_only(const std::set<std::string>& components) {
  std::erase_if(entries_, [&](const auto& one) { return !components.contains(one.first); });
}

}  // namespace mauve::daemon
