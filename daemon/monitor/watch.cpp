// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/watch.h"

#include <algorithm>

#include "arch/text/value_json.h"
#include "base/mutex.h"
#include "base/thread_role.h"
#include "commands/look/value.h"
#include "mauve/host/architecture.h"
#include "rt/process/pulse.h"

namespace mauve::daemon {

namespace {

constexpr std::chrono::milliseconds kPeriod{10};
constexpr unsigned kLooks = 10;  // periods between two looks whether tapped services are there
/// A resource that was held for so long that it could not be tapped is left alone for a while.
constexpr std::chrono::seconds kBusy{1};
constexpr std::size_t kTapBytes = 4 * 1024 * 1024;
/// A second's worth of a fast small value, two of a very large one.
std::size_t capacity_for(const DataType& data) {
  return std::clamp<std::size_t>(kTapBytes / std::max<std::size_t>(data.size, 1), 2, 2048);
}

/// Two samples are the same when value, status and time are equal.
bool same_sample(const Json& a, const Json& b) {
  return a.is_object() && b.is_object() && a["value"] == b["value"] && a["status"] == b["status"] &&
         a.value("t_ns", Json()) == b.value("t_ns", Json());
}

}  // namespace

Watches::Tapped::Tapped(std::string at, ServiceBase& tapped, const Architecture& lives_in)
    : address(std::move(at)),
      keep(tapped.resource().keep_alive()),
      service(tapped.address()),
      architecture(lives_in),
      list(tapped.taps()),
      resource_lock(tapped.resource().lock()),
      tap(std::make_shared<Tap>(*tapped.signature().data, capacity_for(*tapped.signature().data))) {
  attached = list->attach(tap, resource_lock);
}

Watches::Tapped::~Tapped() {
  if (attached && is_there()) {
    list->detach(*tap, resource_lock);
  }
}

bool Watches::Tapped::is_there() const {
  const auto now = architecture.find_service(service);
  return now && (*now)->taps() == list;
}

void Watches::start(Running& running) {
  running_ = &running;
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::watch);
    run();
  });
}

void Watches::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
  remove([](std::uint64_t, std::uint64_t) { return true; });
}

Result<std::uint64_t> Watches::subscribe(const Running& running, const server::Caller& caller,
                                         const std::vector<std::string>& addresses) {
  MAUVE_ON_THREAD(control);
  if (addresses.empty() || addresses.size() > kMaxAddresses) {
    return refuse({Errc::limit, "too_many_subscriptions"}, "addresses",
                  "one subscription takes 1 to " + std::to_string(kMaxAddresses) + " addresses",
                  "use several subscriptions");
  }
  const auto sub = caller.outbox->open();
  if (!sub) {
    return refuse({Errc::limit, "too_many_subscriptions"}, "subscriptions",
                  "this connection has too many", "end some of them");
  }
  for (const auto& address : addresses) {
    if (auto added = add(running, address, {caller.client, *sub, caller.outbox}); !added) {
      unsubscribe(caller, *sub);
      return added.error();
    }
  }
  wake_.notify_all();
  return *sub;
}

Status Watches::add(const Running& running, const std::string& address, const Subscriber& who) {
  const auto target = find_target(running, address);
  if (target && target->service != nullptr && target->service->taps() != nullptr) {
    return tap(address, *target->service, who);
  }
  auto now = sample_at(running, address);
  if (!now) {
    return now.error();
  }
  const auto same = [&](const Polled& one) { return one.address == address; };
  auto found = std::find_if(polled_.begin(), polled_.end(), same);
  if (found == polled_.end()) {
    found = polled_.insert(found, {address, *now, {}});
  }
  found->subscribers.push_back(who);
  auto params = *std::move(now);
  params.emplace("t_ns", running.deployer.clock().now() - running.deployer.t0());
  who.outbox->push(who.sub, address, "value", protocol::NotificationText(params));
  const MutexLock lock(mutex_);
  has_polled_ = true;
  return ok();
}

Status Watches::tap(const std::string& address, ServiceBase& service, const Subscriber& who) {
  const auto* data = service.signature().data;
  if (data == nullptr || data->to_value == nullptr) {
    return refuse({Errc::unsupported, "type_not_described"}, address, "its type has no description",
                  "describe it: a static type_name and fields(), see mauve/type.h");
  }
  const MutexLock lock(mutex_);
  const auto same = [&](const Tapped& one) { return one.address == address; };
  auto found = std::find_if(tapped_.begin(), tapped_.end(), same);
  if (found == tapped_.end()) {
    found = tapped_.emplace(found, address, service, running_->architecture);
    if (auto attached = found->attached; !attached) {
      tapped_.erase(found);
      attached.error().at = address;
      return attached;
    }
  }
  found->subscribers.push_back(who);
  return ok();
}

Result<Watches::FollowedLog> Watches::follow_log(
    const server::Caller& caller, const logging::Filter& filter, std::size_t count,
    std::function<Json(const logging::Record&)> encode) {
  MAUVE_ON_THREAD(control);
  const auto sub = caller.outbox->open();
  if (!sub) {
    return refuse({Errc::limit, "too_many_subscriptions"}, "subscriptions",
                  "this connection has too many", "end some of them");
  }
  auto following =
      log_.history().follow(count, filter,
                            [outbox = caller.outbox, sub = *sub, encode = std::move(encode),
                             last = written_](const logging::Record& record) {
                              if (!last->text || last->seq != record.seq) {
                                last->text.emplace(encode(record));
                                last->seq = record.seq;
                              }
                              outbox->push(sub, {}, "log", *last->text);
                            });
  followers_.push_back({caller.client, *sub, following.id});
  return FollowedLog{*sub, std::move(following.kept)};
}

bool Watches::unsubscribe(const server::Caller& caller, std::uint64_t sub) {
  MAUVE_ON_THREAD(control);
  remove([&](std::uint64_t client, std::uint64_t number) {
    return client == caller.client && number == sub;
  });
  return caller.outbox->close(sub);
}

void Watches::forget(std::uint64_t client) {
  MAUVE_ON_THREAD(io);
  running_->control.read([this, client] {
    remove([client](std::uint64_t other, std::uint64_t) { return other == client; });
  });
}

void Watches::remove(const Leaves& leaves) {
  const auto clean = [&](auto& watched, const auto* in_use) {
    std::remove_cvref_t<decltype(watched)> unwatched;
    for (auto one = watched.begin(); one != watched.end();) {
      const auto here = one++;
      std::erase_if(here->subscribers,
                    [&](const Subscriber& who) { return leaves(who.client, who.sub); });
      if (here->subscribers.empty() && &*here != in_use) {
        unwatched.splice(unwatched.end(), watched, here);
      }
    }
    return unwatched;
  };
  clean(polled_, static_cast<const Polled*>(nullptr));
  clean(lost_, static_cast<const Lost*>(nullptr));
  std::erase_if(followers_, [&](const LogFollower& one) {
    const bool gone = leaves(one.client, one.sub);
    if (gone) {
      log_.history().unfollow(one.follower);
    }
    return gone;
  });
  std::list<Tapped> no_ports;  // without mutex_: the lock of a resource may be held for long
  const MutexLock lock(mutex_);
  has_polled_ = !polled_.empty() || !lost_.empty();
  no_ports = clean(tapped_, reading_);
}

void Watches::run() {
  rt::Pulse pulse("watch");
  MutexLock lock(mutex_);
  while (!stopping_) {
    pulse.turn();
    const auto wanted = [this]() MAUVE_REQUIRES(mutex_) {
      return stopping_ || has_polled_ || !tapped_.empty();
    };
    if (!wanted()) {
      wake_.wait_for(lock, rt::Pulse::kTurn, wanted);
      continue;
    }
    bring_round(lock);
    const bool due = ++rounds_ % kLooks == 0;
    if ((has_polled_ || due) && !std::exchange(poll_pending_, true)) {
      running_->control.read([this] { poll(); });
    }
    wake_.wait_for(lock, kPeriod, [this]() MAUVE_REQUIRES(mutex_) { return stopping_; });
  }
}

/// Each round begins where the one before ended, so that no tap waits for ever. [watch]
void Watches::bring_round(MutexLock& lock) {
  MAUVE_ON_THREAD(watch);
  Round round;
  const auto goes_on = [&]() MAUVE_REQUIRES(mutex_) {
    return round.goes_on() && !stopping_ && !tapped_.empty();
  };
  for (std::size_t taps = tapped_.size(); taps > 0 && goes_on(); --taps) {
    tapped_.splice(tapped_.end(), tapped_, tapped_.begin());
    Tapped& one = tapped_.back();
    const auto subscribers = one.subscribers;  // they may change while the lock is given back
    reading_ = &one;
    lock.unlock();
    bring_some(one, subscribers, round);
    lock.lock();
    reading_ = nullptr;
  }
}

bool Watches::Round::goes_on() const {
  return notifications > 0 && std::chrono::steady_clock::now() < until;
}

/// Every sample is written out once, for all its subscribers; at least one sample. [watch], or
/// [control] for a tap that [watch] does not know any more.
void Watches::bring_some(const Tapped& one, const std::vector<Subscriber>& subscribers,
                         Round& round) const {
  const auto& type = one.tap->data();
  bool wanted = false;
  const auto bring = [&](const void* value, Instant stamp) {
    const protocol::NotificationText text(Json{{"address", one.address},
                                               {"value", arch::to_json(type.to_value(value))},
                                               {"status", to_string(DataStatus::new_data)},
                                               {"t_ns", stamp - running_->deployer.t0()}});
    wanted = false;
    for (const auto& who : subscribers) {
      wanted = who.outbox->push(who.sub, one.address, "value", text) || wanted;
    }
    round.notifications -= std::min(round.notifications, subscribers.size());
  };
  while (one.tap->pop(bring) && wanted && round.goes_on()) {
  }
  report_lost(one, subscribers, one.tap->take_lost());
}

void Watches::report_lost(const Tapped& one, const std::vector<Subscriber>& subscribers,
                          std::uint64_t lost) {
  if (lost == 0) {
    return;
  }
  for (const auto& who : subscribers) {
    who.outbox->lose(who.sub, one.address, lost);
  }
}

void Watches::poll() {
  poll_values();
  leave_replaced();
  find_replacements();
  const MutexLock lock(mutex_);
  has_polled_ = !polled_.empty() || !lost_.empty();
  poll_pending_ = false;
}

/// Also takes away the taps without a subscriber. One that [watch] reads just now stays until the
/// next look. [control]
void Watches::leave_replaced() {
  std::list<Tapped> left;  // goes without mutex_, as in remove()
  {
    const MutexLock lock(mutex_);
    for (auto one = tapped_.begin(); one != tapped_.end();) {
      const auto here = one++;
      if (&*here != reading_ && (here->subscribers.empty() || !here->is_there())) {
        left.splice(left.end(), tapped_, here);
      }
    }
  }
  Round round;
  for (auto& one : left) {
    if (one.subscribers.empty()) {
      continue;
    }
    // Its last values. The subscribers learn how many more are lost.
    bring_some(one, one.subscribers, round);
    std::uint64_t rest = 0;
    while (one.tap->pop([](const void*, Instant) {})) {
      ++rest;
    }
    report_lost(one, one.subscribers, rest);
    lost_.push_back({one.address, std::move(one.subscribers)});
  }
}

void Watches::find_replacements() {
  const auto now = std::chrono::steady_clock::now();
  for (auto& one : lost_) {
    std::erase_if(one.subscribers, [&](const Subscriber& who) {
      if (now < one.not_before) {
        return false;
      }
      const auto found = add(*running_, one.address, who);
      if (found) {
        who.outbox->push(who.sub, one.address, "replaced",
                         protocol::NotificationText(Json{{"address", one.address}}));
      } else if (found.error().code == Errc::timed_out) {
        one.not_before = now + kBusy;
      }
      return found.has_value();
    });
  }
  std::erase_if(lost_, [](const Lost& one) { return one.subscribers.empty(); });
  for (auto& one : lost_) {
    if (std::exchange(one.reported, true)) {
      continue;
    }
    for (const auto& who : one.subscribers) {
      who.outbox->push(who.sub, one.address, "value",
                       protocol::NotificationText(Json{
                           {"address", one.address}, {"value", nullptr}, {"status", "no_data"}}));
    }
  }
}

/// An address that stopped having a value (a core without that observable) is sent as null once.
void Watches::poll_values() {
  const auto time = running_->deployer.clock().now() - running_->deployer.t0();
  Round round;
  for (std::size_t left = polled_.size(); left > 0 && round.goes_on(); --left) {
    polled_.splice(polled_.end(), polled_, polled_.begin());
    Polled& one = polled_.back();
    auto now = sample_at(*running_, one.address);
    auto params = now ? *std::move(now)
                      : Json{{"address", one.address}, {"value", nullptr}, {"status", "no_data"}};
    if (same_sample(params, one.last)) {
      continue;
    }
    one.last = params;
    params.emplace("t_ns", time);
    const protocol::NotificationText text(params);
    for (const auto& who : one.subscribers) {
      who.outbox->push(who.sub, one.address, "value", text);
    }
  }
}

}  // namespace mauve::daemon
