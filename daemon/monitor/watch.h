// SPDX-License-Identifier: LGPL-3.0-or-later
/// Watches: clients that want to see every new value of some addresses, or every log record.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "commands/command.h"
#include "mauve/detail/tap.h"

namespace mauve::daemon {

/// Values written to shared data or a queue are all seen, through a bounded tap that its writer
/// never waits for. [watch] takes a bounded number of them in a round; for more, the tap reports a
/// loss. Everything else (properties, observables, ports, services that compute their value) is
/// polled 50 times a second and sent when it differs. The watch of a resource that is replaced
/// reports that, and goes on at the one that has its name; when none has it, one value is null.
class Watches {
 public:
  explicit Watches(logging::Log& log) : log_(log) {}
  ~Watches() { stop(); }
  Watches(const Watches&) = delete;
  Watches& operator=(const Watches&) = delete;

  /// Starts the [watch] thread, which brings values from the taps to the clients. [main]
  void start(Running& running);
  /// Ends the thread and all watches: before the architecture goes. [main], [control] has ended.
  void stop();

  /// All addresses, or none and the error of the first wrong one. [control]
  Result<std::uint64_t> subscribe(const Running& running, const server::Caller& caller,
                                  const std::vector<std::string>& addresses);
  struct FollowedLog {
    std::uint64_t sub = 0;
    std::vector<logging::Record> kept;
  };
  /// The kept records; the later ones go to the client. [control]
  Result<FollowedLog> follow_log(const server::Caller& caller, const logging::Filter& filter,
                                 std::size_t count,
                                 std::function<Json(const logging::Record&)> encode);
  /// [control]
  bool unsubscribe(const server::Caller& caller, std::uint64_t sub);
  /// The client has gone. [io]
  void forget(std::uint64_t client);

  static constexpr std::size_t kMaxAddresses = 64;  ///< of one subscription

 private:
  struct Subscriber {
    std::uint64_t client;
    std::uint64_t sub;
    std::shared_ptr<server::Outbox> outbox;
  };
  struct Tapped {
    Tapped(std::string at, ServiceBase& tapped, const Architecture& lives_in);
    ~Tapped();
    /// The resource may have left, and its lock with it, or another one has its name.
    [[nodiscard]] bool is_there() const;

    std::string address;
    std::shared_ptr<void> keep;  ///< the resource's elements and their library
    std::string service;         ///< its own address
    const Architecture& architecture;
    TapList* list;
    ResourceLock& resource_lock;
    std::shared_ptr<Tap> tap;
    Status attached;
    std::vector<Subscriber> subscribers;
  };
  struct Polled {
    std::string address;
    Json last;
    std::vector<Subscriber> subscribers;
  };
  /// Tapped a resource that left.
  struct Lost {
    std::string address;
    std::vector<Subscriber> subscribers;
    bool reported = false;
    std::chrono::steady_clock::time_point not_before = {};
  };
  /// The record that was written out last, once for all followers of the log. [log]
  struct WrittenRecord {
    std::uint64_t seq = 0;
    std::optional<protocol::NotificationText> text;
  };
  struct LogFollower {
    std::uint64_t client;
    std::uint64_t sub;
    std::uint64_t follower;
  };
  using Leaves = std::function<bool(std::uint64_t client, std::uint64_t sub)>;

  Status add(const Running& running, const std::string& address, const Subscriber& who);
  Status tap(const std::string& address, ServiceBase& service, const Subscriber& who);
  void poll();
  void poll_values();
  void leave_replaced();
  void find_replacements();
  void run();
  /// `lock` holds mutex_, and is given back while values are written out.
  void bring_round(MutexLock& lock) MAUVE_REQUIRES(mutex_) MAUVE_NOT_ANALYSED;
  /// The budget of one round, over all clients. More samples wait in their taps, and are sent as
  /// lost when those are full.
  struct Round {
    std::size_t notifications = 8192;
    std::chrono::steady_clock::time_point until =
        std::chrono::steady_clock::now() + std::chrono::milliseconds(5);
    [[nodiscard]] bool goes_on() const;
  };
  void bring_some(const Tapped& one, const std::vector<Subscriber>& subscribers,
                  Round& round) const;
  static void report_lost(const Tapped& one, const std::vector<Subscriber>& subscribers,
                          std::uint64_t lost);
  void remove(const Leaves& leaves);

  logging::Log& log_;
  Running* running_ = nullptr;
  std::list<Polled> polled_;            ///< [control]
  std::list<Lost> lost_;                ///< [control]
  std::vector<LogFollower> followers_;  ///< [control]
  std::shared_ptr<WrittenRecord> written_ = std::make_shared<WrittenRecord>();

  Mutex mutex_;  ///< guards the following; never held while a value is read or written out
  ConditionVariable wake_;
  std::list<Tapped> tapped_ MAUVE_GUARDED_BY(mutex_);
  const Tapped* reading_ MAUVE_GUARDED_BY(mutex_) =
      nullptr;  ///< [watch] reads it without mutex_; no other thread takes it away
  bool has_polled_ MAUVE_GUARDED_BY(mutex_) = false;
  bool poll_pending_ MAUVE_GUARDED_BY(mutex_) = false;
  unsigned rounds_ MAUVE_GUARDED_BY(mutex_) = 0;
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace mauve::daemon
