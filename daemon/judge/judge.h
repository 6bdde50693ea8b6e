// SPDX-License-Identifier: LGPL-3.0-or-later
/// [judge]: files of clients are judged in a process of their own, one after another.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "changes/control.h"
#include "judge/judgement.h"
#include "mauve/time.h"
#include "options.h"
#include "rt/process/child.h"

namespace mauve::daemon {

/// A file that a client sends names plugins, elements and values. To judge whether it is good, all
/// of it must be made, so constructors, converters and checks of plugins run, with any size.
/// Nothing of that happens in mauved itself: it starts itself anew as `mauved --judge`, which has
/// limits on memory and time, no privileges, and only its answer to give.
class Judge {
 public:
  using Then = std::function<void(Result<Json>)>;

  explicit Judge(Control& control) : control_(control) {}
  ~Judge() { stop(); }
  Judge(const Judge&) = delete;
  Judge& operator=(const Judge&) = delete;

  /// `command`: a mauved with its options, but for `--judge`. [main]
  void start(std::vector<std::string> command, Duration within);
  /// Kills the process that judges now; questions that wait are dropped. [main]
  void stop();

  /// [any] Judges, then calls `then` on [control]: with judge()'s result, or with the reason why
  /// there is none. Files of operators and admins come before those of viewers, and users take
  /// turns. Refused at once when this user has kMostOfOneUser files waiting.
  void ask(const Asker& asker, const Question& question, Then then);

  static constexpr std::size_t kMostOfOneUser = 2;

 private:
  [[nodiscard]] Result<Json> judged(const std::string& question);
  [[nodiscard]] Status claim_slot(uid_t user);
  void release_slot(uid_t user);

  Control& control_;
  std::vector<std::string> command_;
  Duration within_{0};
  rt::ChildRunner runner_;
  Mutex mutex_;
  std::map<uid_t, std::size_t> waiting_ MAUVE_GUARDED_BY(mutex_);  // under mutex_
  WorkerThread thread_{ThreadRole::judge};
};

/// This program again, with the options that a file is judged with. [any]
[[nodiscard]] std::vector<std::string> judge_command(const Options& options);

/// Judges once, by this command: for a daemon that has no threads yet. [main]
[[nodiscard]] Result<Json> judge_apart(const Options& options, const Question& question);

/// Whether code of a plugin ended the process, or was ended with it; any other refusal is no
/// verdict on the file. [any]
[[nodiscard]] bool died(const Error& verdict);

/// The answer of the process that has ended, or the reason why it gave none. [any]
[[nodiscard]] Result<Json> verdict_of(const rt::ChildEnd& end, Duration within);

}  // namespace mauve::daemon
