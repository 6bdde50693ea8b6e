// SPDX-License-Identifier: LGPL-3.0-or-later
/// A change is one cut through all its members: jobs released before its instant are old, at or
/// after it new; all take it, or none does.
#include <algorithm>
#include <optional>

#include "mtrace/findings.h"

namespace mauve::ctl::mtrace {
namespace {

using Threads = std::map<Word, std::vector<const Record*>>;

struct Take {
  Word thread = 0;
  const Record* applied = nullptr;
  const Record* before = nullptr;  ///< last release with the old one, as far as seen
  const Record* after = nullptr;   ///< first release with the new one
};

struct Change {
  const Record* commit = nullptr;   ///< or rollback, the last one; null: before the trace
  const Record* aborted = nullptr;  ///< after the last commit
  std::vector<Word> members;
  std::vector<Take> takes;
  std::vector<Take> backs;
  std::vector<Take> steps;  ///< of a barrier: it waits, and goes on, each at an instant of its own

  [[nodiscard]] bool is_applied_by(Word thread) const {
    const auto is_its = [&](const Take& one) { return one.thread == thread; };
    return std::any_of(takes.begin(), takes.end(), is_its) ||
           std::any_of(backs.begin(), backs.end(), is_its) ||
           std::any_of(steps.begin(), steps.end(), is_its);
  }
};

class ChangesCheck {
 public:
  ChangesCheck(Findings& findings, const Threads& threads)
      : findings_(findings), trace_(findings.trace()), threads_(threads) {}

  void run() {
    for (const auto& [thread, records] : threads_) {
      trace_.text(thread) == kControl ? read_control(records) : read_takes(thread, records);
    }
    for (const auto& [number, change] : changes_) {
      const bool applied = !change.takes.empty() || !change.backs.empty() || !change.steps.empty();
      if (change.commit == nullptr && !applied) continue;
      ++findings_.checked.changes;
      for (const auto* takes : {&change.takes, &change.backs, &change.steps}) {
        for (const Take& take : *takes) cut(number, take);
      }
      one_instant(number, change.takes);
      one_instant(number, change.backs);
      all_or_none(number, change);
    }
  }

 private:
  void read_control(const std::vector<const Record*>& records) {
    for (const Record* record : records) {
      if (record->event == Event::commit || record->event == Event::rollback) {
        Change& change = changes_[record->b];
        change.commit = record;
        change.aborted = nullptr;
        change.members.clear();
      } else if (record->event == Event::abort) {
        changes_[record->b].aborted = record;
      } else if (record->event == Event::member) {
        changes_[record->b].members.push_back(record->name);
      }
    }
  }

  void read_takes(Word thread, const std::vector<const Record*>& records) {
    const Record* last = nullptr;
    std::vector<std::pair<std::vector<Take>*, std::size_t>> open;  // wait for their first release
    for (const Record* record : records) {
      if (record->event == Event::lost) {
        last = nullptr;
        open.clear();
      } else if (record->event == Event::release) {
        for (const auto& [takes, index] : open) (*takes)[index].after = record;
        open.clear();
        last = record;
      } else if (record->event == Event::applied && trace_.text(record->name) != "standby") {
        auto& takes = takes_of(changes_[record->b], trace_.text(record->name));
        takes.push_back({thread, record, last});
        open.emplace_back(&takes, takes.size() - 1);
      }
    }
  }

  static std::vector<Take>& takes_of(Change& change, const std::string& kind) {
    if (kind == "barrier") return change.steps;
    return kind == "back" ? change.backs : change.takes;
  }

  void cut(std::int64_t number, const Take& take) {
    const std::int64_t instant = take.applied->a;
    if (instant == kNoInstant) return findings_.left_out("changes without an instant");
    ++findings_.checked.takes;
    const std::string change = change_called(number);
    if (take.before != nullptr && take.before->a >= instant) {
      fail(*take.applied, "took " + change + " late: its instant is " + instant_in_words(instant) +
                              ", and the job released for " + instant_in_words(take.before->a) +
                              " still ran without it");
    }
    if (take.after != nullptr && take.after->a < instant) {
      fail(*take.applied, "took " + change + " early: its instant is " + instant_in_words(instant) +
                              ", and the job released for " + instant_in_words(take.after->a) +
                              " ran with it already");
    }
  }

  void one_instant(std::int64_t number, const std::vector<Take>& takes) {
    for (const Take& take : takes) {
      if (take.applied->a == takes.front().applied->a) continue;
      fail(*take.applied, "took " + change_called(number) + " with the instant " +
                              instant_in_words(take.applied->a) + ", and " +
                              trace_.text(takes.front().thread) + " with " +
                              instant_in_words(takes.front().applied->a));
      return;
    }
  }

  void all_or_none(std::int64_t number, const Change& change) {
    if (change.commit == nullptr) {
      return findings_.left_out("changes committed before the trace, for who else took part");
    }
    if (change.aborted != nullptr) {
      for (const Take& take : change.takes) {
        if (take.applied->a != change.commit->a) continue;
        fail(*take.applied, "took " + change_called(number) + ", which was aborted");
        return;
      }
      return;
    }
    for (const Word member : change.members) {
      if (!change.is_applied_by(member)) missing(number, change, member);
    }
  }

  /// A member that never applied the change: did it run on without it?
  void missing(std::int64_t number, const Change& change, Word member) {
    const auto records = threads_.find(member);
    if (records == threads_.end()) {
      return findings_.left_out("members of changes that did nothing in the trace");
    }
    const std::int64_t instant = change.commit->a;
    // A record of [control] may come later than the instant, and that before the trace begins.
    const Record& first = *records->second.front();
    if (instant != kNoInstant && instant < first.time) {
      return findings_.left_out("changes before the trace, for members that took part");
    }
    bool before = false;  // it was there before the change; else it joined with it
    for (const Record* record : records->second) {
      before = before || record->time < change.commit->time;
      if (record->time < change.commit->time) continue;
      const bool explained = record->event == Event::lost || record->event == Event::fault ||
                             record->event == Event::stopped || record->event == Event::started;
      if (explained) return;
      if (record->event != Event::release || record->a < instant) continue;
      if (!before || instant == kNoInstant) return;
      const bool alone = change.takes.empty();
      return fail(*record,
                  "never took " + change_called(number) + ": its instant is " +
                      instant_in_words(instant) + ", and it was released for " +
                      instant_in_words(record->a) +
                      (alone ? "" : "; " + trace_.text(change.takes.front().thread) + " took it"));
    }
    findings_.left_out("members of changes that had no release behind the instant");
  }

  static std::string change_called(std::int64_t number) {
    return "change " + std::to_string(number);
  }
  void fail(const Record& at, const std::string& message) {
    findings_.violation(at, "cut", trace_.text(at.thread) + " " + message,
                        "jobs released before the instant are old everywhere, at or after it new");
  }

  Findings& findings_;
  const Trace& trace_;
  const Threads& threads_;
  std::map<std::int64_t, Change> changes_;
};

}  // namespace

void check_changes(Findings& findings, const Threads& threads) {
  ChangesCheck(findings, threads).run();
}

}  // namespace mauve::ctl::mtrace
