// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components that stamp which job ran with the core of which transaction. A check shows that each
/// transaction is a consistent cut: jobs before its instant are old everywhere, all others new.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/plugin.h>

namespace stampers {

inline constexpr std::size_t kCount = 20;

/// Of one component: its jobs in a row with the core of the same transaction.
class Log {
 public:
  struct Stretch {
    int version;
    mauve::Instant first;  ///< releases
    mauve::Instant last;
    std::size_t jobs;
  };

  /// By the thread of the component only.
  void note(mauve::Instant release, int version) {
    const std::size_t count = count_.load(std::memory_order_relaxed);
    if (count > 0 && stretches_[count - 1].version == version) {
      stretches_[count - 1].last = release;
      ++stretches_[count - 1].jobs;
    } else if (count < stretches_.size()) {
      stretches_[count] = {version, release, release, 1};
      count_.store(count + 1, std::memory_order_release);
    }
  }
  void clear() { count_ = 0; }
  [[nodiscard]] bool full() const { return count_ == stretches_.size(); }
  /// Of the newest job; -1: none ran.
  [[nodiscard]] int version() const {
    const std::size_t count = count_.load(std::memory_order_acquire);
    return count == 0 ? -1 : stretches_[count - 1].version;
  }
  /// When no thread stamps any more.
  [[nodiscard]] std::vector<Stretch> stretches() const {
    return {stretches_.begin(), stretches_.begin() + static_cast<std::ptrdiff_t>(count_.load())};
  }

 private:
  std::array<Stretch, 4096> stretches_{};
  std::atomic<std::size_t> count_{0};
};

inline std::array<Log, kCount>& logs() {
  static auto* const all = new std::array<Log, kCount>;
  return *all;
}
inline void clear_logs() {
  for (Log& log : logs()) log.clear();
}

struct Shell : mauve::Shell {
  mauve::Property<std::int64_t> number{*this, "number", 0, "index of the component"};
};

struct Stamper : mauve::Core<Shell> {
  mauve::Stateless stateless{*this};
  mauve::Property<std::int64_t> version{*this, "version", 0, "the transaction that brought it"};
  void update() {
    logs()[static_cast<std::size_t>(shell().number.get())].note(mauve::this_job().release,
                                                                static_cast<int>(version.get()));
  }
};
using Fsm = mauve::PeriodicFsm<Stamper>;

/// With periods of 1 to 5 ms, so that members come to the instant at different times.
struct Architecture : mauve::Architecture {
  explicit Architecture(int priority = mauve::TaskAttributes{}.priority) {
    for (std::size_t i = 0; i < kCount; ++i) {
      auto component = std::make_shared<mauve::ComponentBase>(
          "c" + std::to_string(i),
          mauve::ComponentType{"stamper", mauve::ShellType::of<Shell>(),
                               mauve::FsmType::of<Fsm>("stamper"), "stamper"},
          mauve::CoreType::of<Stamper>("stamper"));
      const auto number = static_cast<std::int64_t>(i);
      static_cast<void>(component->shell().find_property("number")->set(mauve::Value(number)));
      static_cast<Fsm&>(component->fsm()).period = std::chrono::milliseconds(1 + i % 5);
      component->task().priority = priority;
      own(std::move(component));
    }
  }
};

/// Gives all of them the core of that transaction.
inline mauve::Change to_version(int version) {
  mauve::Change change;
  for (std::size_t i = 0; i < kCount; ++i) {
    mauve::Edit edit;
    edit.member = "c" + std::to_string(i);
    edit.properties.emplace_back("core.version", static_cast<std::int64_t>(version));
    change.edits.push_back(std::move(edit));
  }
  return change;
}

/// Has each run a job with the core of that transaction?
inline bool all_ran(int version) {
  return std::all_of(logs().begin(), logs().end(),
                     [version](const Log& log) { return log.version() == version; });
}

struct Cut {
  std::size_t jobs = 0;
  std::vector<std::string> violations;
};

/// `commits`: the instants of the transactions, from version 1 on. Newer versions are not looked
/// at.
inline Cut check(const std::vector<mauve::Instant>& commits) {
  Cut cut;
  for (const Log& log : logs()) {
    if (log.full()) cut.violations.emplace_back("there was no room for all jobs");
    for (const Log::Stretch& stretch : log.stretches()) {
      const auto version = static_cast<std::size_t>(stretch.version);
      if (version > commits.size()) continue;
      cut.jobs += stretch.jobs;
      const bool begun = version == 0 || stretch.first >= commits[version - 1];
      const bool over = version < commits.size() && stretch.last >= commits[version];
      if (begun && !over) continue;
      cut.violations.push_back("version " + std::to_string(version) + " ran in releases from " +
                               std::to_string(stretch.first) + " to " +
                               std::to_string(stretch.last));
    }
  }
  return cut;
}

}  // namespace stampers
