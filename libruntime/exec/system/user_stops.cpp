// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/user_stops.h>

#include <algorithm>
#include <utility>

namespace mauve {

void UserStops::stop(const std::string& component, UserStop stop) {
  stop.number = ++newest_;
  named_[component] = std::move(stop);
  ++revision_;
}

void UserStops::stop_all(UserStop stop) {
  stop.number = ++newest_;
  all_ = std::move(stop);
  named_.clear();
  started_.clear();
  ++revision_;
}

void UserStops::start(const std::string& component, std::uint64_t known, Ends ends) {
  const UserStop* const stop = of(component);
  if (stop != nullptr && stop->number <= known && ends == Ends::unless_undone)
    ended_[component] = *stop;
  const auto found = named_.find(component);
  if (found != named_.end() && found->second.number <= known) named_.erase(found);
  if (all_ && all_->number <= known) started_.insert(component);
  ++revision_;
}

void UserStops::start_all(std::uint64_t known) {
  std::erase_if(named_, [known](const auto& one) { return one.second.number <= known; });
  if (all_ && all_->number <= known) {
    all_.reset();
    started_.clear();
  }
  ++revision_;
}

void UserStops::stand_again(const std::string& component) {
  auto ended = ended_.extract(component);
  if (ended.empty()) return;
  if (of(component) == nullptr) named_.insert(std::move(ended));
  ++revision_;
}

void UserStops::end_for_good(const std::string& component) {
  if (ended_.erase(component) > 0) ++revision_;
}

std::shared_ptr<const void> UserStops::begin(std::vector<std::string> components) {
  auto names = std::make_shared<const std::vector<std::string>>(std::move(components));
  std::erase_if(under_way_, [](const auto& one) { return one.expired(); });
  under_way_.push_back(names);
  return names;
}

bool UserStops::is_under_way(std::string_view component) const {
  return std::any_of(under_way_.begin(), under_way_.end(), [component](const auto& one) {
    const auto names = one.lock();
    const bool of_all = names != nullptr && names->empty();
    return of_all ||
           (names != nullptr && std::find(names->begin(), names->end(), component) != names->end());
  });
}

const UserStop* UserStops::of(std::string_view component) const {
  const auto found = named_.find(component);
  if (found != named_.end()) return &found->second;
  return all_ && !started_.contains(component) ? &*all_ : nullptr;
}

}  // namespace mauve
