// SPDX-License-Identifier: LGPL-3.0-or-later
/// How often something happened since mauved began, for `metrics`.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/mutex.h"
#include "mauve/host/report.h"

namespace mauve::daemon {

class Counts {
 public:
  using OfMethods = std::map<std::string, std::uint64_t, std::less<>>;
  /// By method and the name of the error.
  using OfRefusals = std::map<std::pair<std::string, std::string>, std::uint64_t>;
  using OfComponents = std::map<std::string, std::uint64_t>;

  /// [any but rt] A request of this method has its answer; `error` is empty when it is no refusal.
  void answered(std::string_view method, std::string_view error) {
    const MutexLock lock(mutex_);
    ++answers_[std::string(method)];
    if (!error.empty()) {
      ++refusals_[{std::string(method), std::string(error)}];
    }
  }
  /// [control] An action of the system by itself.
  void note(const Outcome& outcome) { ++outcomes_[outcome.kind][outcome.component]; }

  /// The answers of each method: also of reads, of dry runs, and refusals.
  [[nodiscard]] OfMethods answers() const {
    const MutexLock lock(mutex_);
    return answers_;
  }
  [[nodiscard]] OfRefusals refusals() const {
    const MutexLock lock(mutex_);
    return refusals_;
  }
  /// [control] By component; an empty name: no component was at fault.
  [[nodiscard]] OfComponents of(Outcome::Kind kind) const {
    const auto found = outcomes_.find(kind);
    return found == outcomes_.end() ? OfComponents() : found->second;
  }

 private:
  mutable Mutex mutex_;
  OfMethods answers_ MAUVE_GUARDED_BY(mutex_);
  OfRefusals refusals_ MAUVE_GUARDED_BY(mutex_);
  std::map<Outcome::Kind, OfComponents> outcomes_;  // [control]
};

}  // namespace mauve::daemon
