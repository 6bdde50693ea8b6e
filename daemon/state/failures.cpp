// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/failures.h"

#include <array>
#include <utility>

namespace mauve::daemon {

namespace {

/// The rings are emptied 50 times a second.
constexpr std::int64_t kLogNeeds = 200'000'000;

}  // namespace

std::string_view to_string(Reaction reaction) {
  constexpr std::array<std::string_view, 5> kNames = {"parked", "rolled_back", "fell_back",
                                                      "restarted", "recovers"};
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
  const std::uint64_t before = entry.failure ? entry.failure->times : 0;
  failure.times = at(component, failure.monotonic_ns) != nullptr ? before : before + 1;
  failure.change = entry.change;
  entry.failure = std::move(failure);
  entry.complete = false;
}

const Failure* Failures::at(const std::string& component, std::int64_t monotonic_ns) const {
  const auto found = entries_.find(component);
  const bool known = found != entries_.end() && found->second.failure &&
                     found->second.failure->monotonic_ns == monotonic_ns;
  return known ? &*found->second.failure : nullptr;
}

bool Failures::knows(const std::string& component, std::int64_t monotonic_ns,
                     Reaction reaction) const {
  const auto* known = at(component, monotonic_ns);
  return known != nullptr &&
         (reaction == Reaction::recovers || known->reaction != Reaction::recovers);
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

/// The records of the component up to the failure.
void Failures::complete(const std::string& component, Entry& entry,
                        const logging::History& history) {
  entry.complete = true;
  auto& failure = *entry.failure;
  logging::Filter filter;
  filter.component = component;
  auto records = history.tail(4 * kRecords, filter);
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
