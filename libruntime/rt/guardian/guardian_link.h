// SPDX-License-Identifier: LGPL-3.0-or-later
/// GuardianLink: the connection of this process to its guardian (guardian/README.md).
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <mauve/result.h>
#include <mauve/time.h>

#include "base/mutex.h"
#include "rt/guardian/guarded_outputs.h"
#include "rt/guardian/guardian_page.h"
#include "rt/guardian/guardian_pulse.h"
#include "rt/process/descriptor.h"
#include "rt/thread/thread.h"

namespace mauve::rt {

/// Where a guardian comes from.
struct GuardianPlan {
  GuardianUse use = GuardianUse::prefer;
  std::string socket;  ///< one that serves here, as a service of its own
  /// Else this program is started, with the number of a descriptor as its last argument. Empty:
  /// none.
  std::vector<std::string> command;
  Duration silence = 60ms;  ///< so long without a beat is an end
  int priority = 0;         ///< SCHED_FIFO of [link] and [safe], where it is permitted
};

/// Where this process stands with its guardian.
struct GuardianState {
  enum class How : std::uint8_t {
    unused,   ///< nothing is to be guarded, or no guardian is looked for
    none,     ///< there is none, though outputs are to be guarded
    service,  ///< it is a service of its own
    started   ///< this process started it
  };
  How how = How::unused;
  std::string why;    ///< none: why. started: why the one that listens got no output, if one does
  Instant since = 0;  ///< none: since when, monotonic
  int process = 0;    ///< its number, when it is there
};

/// An event between mauved and its guardian.
struct GuardianNews {
  enum class What : std::uint8_t {
    found,   ///< it holds the outputs from now on
    absent,  ///< there is none; reported once until there is one
    lost,    ///< it ended, or does not answer any more
    silence  ///< it took this process for dead and sent all orders
  };
  What what = What::found;
  Duration lasted{0};      ///< silence: so far. found: how long there was none
  std::uint32_t done = 0;  ///< silence: orders that went out
  std::uint32_t total = 0;
  GuardianState state;
};

/// A thread that looks for a guardian once there is an output to guard, or at once where one is
/// required. It asks the guardian all the time whether it still serves, and replaces one that does
/// not. While there is none, it looks
/// again each second. One in a process.
class GuardianLink {
 public:
  using Report = std::function<void(const GuardianNews&)>;

  GuardianLink() = default;
  ~GuardianLink() { stop(false); }
  GuardianLink(const GuardianLink&) = delete;
  GuardianLink& operator=(const GuardianLink&) = delete;

  /// `report` is called on the thread of the link.
  Status start(GuardianPlan plan, Report report);
  /// In order: the outputs are safe, so that the guardian lets them go. Else it sends its orders
  /// when it notices that the connection is gone. [any but its own]
  void stop(bool in_order);
  /// Under `require`: waits until one serves. Refused when none can be found. After start().
  /// [any but its own]
  [[nodiscard]] Status found_at_start() const;
  [[nodiscard]] GuardianState state() const;

 private:
  enum class End : std::uint8_t { quit, closed, deaf, replaced };
  /// One that does not answer, or goes: it holds the outputs until another one does.
  struct Former {
    Descriptor socket;
    pid_t child = 0;  // 0: not started here
  };

  void run();
  [[nodiscard]] bool ask_for_one();
  [[nodiscard]] Result<Descriptor> greeted(GuardianState::How& how);
  [[nodiscard]] Result<Descriptor> connected() const;
  [[nodiscard]] Result<Descriptor> started();
  [[nodiscard]] Status greet(int socket, int milliseconds) const;
  [[nodiscard]] End serve(GuardianState::How how, int socket);
  [[nodiscard]] bool finds_service(Instant now);
  [[nodiscard]] bool read_all(int socket);
  void lose(End end, GuardianState::How how, Descriptor socket);
  void let_go_of_former();
  void found(GuardianState::How how, int socket);
  void absent(GuardianNews::What what, const std::string& why);
  void reap();
  [[nodiscard]] bool ring_within(int milliseconds) const;
  void ring() const;

  GuardianPlan plan_;
  Report report_;
  guardian::OwnPage page_;
  Descriptor bell_;
  pid_t child_ = 0;            // started and not reaped
  std::vector<pid_t> dying_;   // started, killed and not reaped: a device may hold them up
  Former former_;              // until there is another one
  std::string passed_over_;    // why one that listens is no guardian; empty: none does
  bool deaf_service_ = false;  // the next attempt leaves it alone
  GuardianPulse pulse_{0};
  Instant sought_ = 0;               // a service
  Descriptor next_;                  // one that was greeted, and serves from the next attempt on
  std::atomic<bool> leaves_{false};  // the end of the connection is not reported any more
  std::atomic<bool> quits_{false};
  int young_deaths_ = 0;  // in a row
  mutable Mutex mutex_;   // of the state
  mutable ConditionVariable changed_;
  GuardianState state_ MAUVE_GUARDED_BY(mutex_);
  Thread thread_;
};

namespace guardian {

/// One message, with a descriptor (-1: none). Never waits. [any]
[[nodiscard]] bool send(int socket, const Request& request, int descriptor);

}  // namespace guardian
}  // namespace mauve::rt
