// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/stopper.h"

#include <algorithm>
#include <iterator>

#include "base/mutex.h"
#include "base/thread_role.h"
#include "mauve/host/deployer.h"
#include "rt/process/pulse.h"
#include "rt/thread/thread.h"

namespace mauve::daemon {

namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

}  // namespace

bool StopOrder::begin() {
  MAUVE_ON_THREAD(control);
  const MutexLock lock(mutex_);
  begun_ = true;
  return direct_ != nullptr;
}

void StopOrder::found(std::vector<std::string> running) {
  MAUVE_ON_THREAD(control);
  const MutexLock lock(mutex_);
  found_ = std::move(running);
}

/// [control] may have ordered some of them to stop before it was held up.
std::vector<std::string> StopOrder::ran() const {
  auto names = direct_->ran();
  std::ranges::copy_if(found_, std::back_inserter(names), [&](const auto& name) {
    return std::ranges::find(names, name) == names.end();
  });
  return names;
}

void StopOrder::end(Deployer& deployer) {
  MAUVE_ON_THREAD(control);
  const MutexLock lock(mutex_);
  over_ = true;
  if (direct_ != nullptr) {
    deployer.end_direct_stop(components_);
  }
}

std::vector<std::string> StopOrder::stopped_directly() const {
  const MutexLock lock(mutex_);
  return direct_ != nullptr ? ran() : std::vector<std::string>();
}

void Stopper::start(Deployer& deployer, int priority, std::function<void(bool)> hasten) {
  deployer_ = &deployer;
  hasten_ = std::move(hasten);
  thread_ = std::thread([this, priority] {
    begin_thread(ThreadRole::stop);
    rt::raise_this_thread(priority);
    run();
  });
}

void Stopper::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Stopper::watch(std::shared_ptr<StopOrder> order) {
  {
    const MutexLock lock(mutex_);
    new_ones_.push_back(std::move(order));
  }
  wake_.notify_all();
}

void Stopper::run() {
  rt::Pulse pulse("stop");
  for (;;) {
    pulse.turn();
    {
      MutexLock lock(mutex_);
      if (orders_.empty()) {
        wake_.wait_for(lock, rt::Pulse::kTurn,
                       [this]() MAUVE_REQUIRES(mutex_) { return stopping_ || !new_ones_.empty(); });
      } else {
        wake_.wait_for(lock, kEvery, [this]() MAUVE_REQUIRES(mutex_) { return stopping_; });
      }
      if (stopping_) {
        return;
      }
      std::move(new_ones_.begin(), new_ones_.end(), std::back_inserter(orders_));
      new_ones_.clear();
    }
    std::erase_if(orders_, [this](const auto& order) { return look(*order); });
    hasten_control();
  }
}

/// Again at each look: the end of a commit takes the priority from [control].
void Stopper::hasten_control() {
  if (orders_.empty() && !hastened_) {
    return;
  }
  hastened_ = !orders_.empty();
  hasten_(hastened_);
}

/// True: there is nothing more to do for it here.
bool Stopper::look(StopOrder& order) {
  const MutexLock lock(order.mutex_);
  if (order.direct_ == nullptr) {
    if (order.over_) {
      return true;
    }
    if (!is_held_up(order)) {
      return false;
    }
    if (!begin_directly(order)) {
      return true;
    }
  }
  if (!order.direct_->advance()) {
    return false;
  }
  return !order.report_ || order.report_(*order.direct_, order.ran());
}

/// It has not come to the stop yet, or has come to it and does not look after it any more.
bool Stopper::is_held_up(StopOrder& order) const {
  const auto looks = deployer_->looks();
  if (order.begun_ && looks != order.looks_) {
    order.looks_ = looks;
    order.waited_ = 0;
    return false;
  }
  return ++order.waited_ > kPatience;
}

bool Stopper::begin_directly(StopOrder& order) {
  if (order.applies_ && !order.applies_()) {
    return false;
  }
  order.direct_ = deployer_->begin_direct_stop(order.components_);
  if (order.direct_ == nullptr) {
    return false;
  }
  if (const auto ran = order.ran(); !ran.empty()) {
    log_.write(logging::Event::stopped_directly, {{"text", listed(ran)}});
  }
  return true;
}

}  // namespace mauve::daemon
