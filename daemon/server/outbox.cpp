// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/outbox.h"

#include "base/thread_role.h"

#include "base/mutex.h"
#include "protocol/message.h"

namespace mauve::server {

using protocol::Json;

Outbox::Outbox(std::size_t max_bytes, std::size_t max_subscriptions, std::function<void()> ready)
    : max_bytes_(max_bytes), max_subscriptions_(max_subscriptions), ready_(std::move(ready)) {}

std::optional<std::uint64_t> Outbox::open() {
  const MutexLock lock(mutex_);
  if (shut_ || open_.size() >= max_subscriptions_) {
    return std::nullopt;
  }
  open_.insert(next_);
  return next_++;
}

bool Outbox::close(std::uint64_t sub) {
  const MutexLock lock(mutex_);
  std::erase_if(items_, [&](const Item& item) MAUVE_REQUIRES(mutex_) {
    if (item.sub == sub) {
      bytes_ -= item.line.size();
    }
    return item.sub == sub;
  });
  std::erase_if(lost_, [&](const auto& entry) { return entry.first.first == sub; });
  return open_.erase(sub) > 0;
}

void Outbox::shut() {
  const MutexLock lock(mutex_);
  shut_ = true;
  open_.clear();
  items_.clear();
  lost_.clear();
  bytes_ = 0;
}

bool Outbox::push(std::uint64_t sub, const std::string& address, std::string_view method,
                  const protocol::NotificationText& params) {
  {
    const MutexLock lock(mutex_);
    if (open_.count(sub) == 0) {
      return false;
    }
    if (bytes_ >= max_bytes_) {
      ++lost_[{sub, address}];
      ++dropped_;
      return true;
    }
  }
  auto line = params.line(method, sub);  // out of the lock, so that [io] does not wait for it
  bool notify = false;
  {
    const MutexLock lock(mutex_);
    if (open_.count(sub) == 0) {
      return false;
    }
    if (const auto lost = lost_.find({sub, address}); lost != lost_.end()) {
      announce(lost);
    }
    queue(sub, std::move(line));
    notify = !std::exchange(notified_, true);
  }
  if (notify) {
    ready_();
  }
  return true;
}

void Outbox::lose(std::uint64_t sub, const std::string& address, std::uint64_t count) {
  bool notify = false;
  {
    const MutexLock lock(mutex_);
    if (open_.count(sub) == 0) {
      return;
    }
    lost_[{sub, address}] += count;
    dropped_ += count;
    notify = !std::exchange(notified_, true);
  }
  if (notify) {
    ready_();
  }
}

void Outbox::queue(std::uint64_t sub, std::string line) {
  bytes_ += line.size();
  items_.push_back({sub, std::move(line)});
}

void Outbox::announce(std::map<Source, std::uint64_t>::iterator lost) {
  const auto [sub, address] = lost->first;
  Json params = {{"sub", sub}, {"count", lost->second}};
  if (!address.empty()) {
    params["address"] = address;
  }
  lost_.erase(lost);
  queue(sub, protocol::to_line(protocol::make_notification("dropped", std::move(params))) + '\n');
}

bool Outbox::is_shut() const {
  const MutexLock lock(mutex_);
  return shut_;
}

std::optional<std::string> Outbox::take() {
  MAUVE_ON_THREAD(io);
  const MutexLock lock(mutex_);
  if (items_.empty() && !lost_.empty()) {
    announce(lost_.begin());
  }
  if (items_.empty()) {
    notified_ = false;
    return std::nullopt;
  }
  auto line = std::move(items_.front().line);
  items_.pop_front();
  bytes_ -= line.size();
  return line;
}

std::size_t Outbox::bytes() const {
  const MutexLock lock(mutex_);
  return bytes_;
}

std::size_t Outbox::subscriptions() const {
  const MutexLock lock(mutex_);
  return open_.size();
}

std::uint64_t Outbox::dropped() const {
  const MutexLock lock(mutex_);
  return dropped_;
}

}  // namespace mauve::server
