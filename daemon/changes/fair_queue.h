// SPDX-License-Identifier: LGPL-3.0-or-later
/// FairQueue: whose request is served next, so that no user holds up another one for longer than
/// one request.
#pragma once

#include <sys/types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <list>
#include <optional>
#include <utility>

#include "server/peer.h"

namespace mauve::daemon {

/// The user that a request comes from. The default is mauved itself.
struct Asker {
  server::Role role = server::Role::none;
  uid_t uid = 0;
};

/// mauved itself comes first, then operators and admins, then viewers; within each of these users
/// take turns. The requests of one user keep their order. Not locked.
template <typename Item>
class FairQueue {
 public:
  void push(const Asker& asker, Item item) {
    auto& users = ranks_.at(rank_of(asker.role));
    auto user = std::find_if(users.begin(), users.end(),
                             [&](const User& one) { return one.uid == asker.uid; });
    if (user == users.end()) {
      user = users.insert(users.end(), {asker.uid, {}});
    }
    user->items.push_back(std::move(item));
    ++size_;
  }

  /// Not of an empty queue.
  Item pop() {
    return *pop([](uid_t) { return true; });
  }
  /// The same, without the requests of viewers for whom `may(uid)` is false. Returns nothing when
  /// no other request is there.
  template <typename May>
  std::optional<Item> pop(const May& may) {
    for (auto& users : ranks_) {
      const auto user = first_of(users, may);
      if (user == users.end()) {
        continue;
      }
      Item item = std::move(user->items.front());
      user->items.pop_front();
      --size_;
      if (user->items.empty()) {
        users.erase(user);
      } else {
        users.splice(users.end(), users, user);
      }
      return item;
    }
    return std::nullopt;
  }
  /// Would pop() find one?
  template <typename May>
  [[nodiscard]] bool has(const May& may) {
    return std::any_of(ranks_.begin(), ranks_.end(),
                       [&](auto& users) { return first_of(users, may) != users.end(); });
  }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct User {
    uid_t uid;
    std::deque<Item> items;  ///< never empty
  };

  static constexpr std::size_t kViewers = 2;
  static std::size_t rank_of(server::Role role) {
    if (role == server::Role::none) {
      return 0;
    }
    return role >= server::Role::operator_ ? 1 : kViewers;
  }

  template <typename May>
  typename std::list<User>::iterator first_of(std::list<User>& users, const May& may) {
    return &users != &ranks_[kViewers]
               ? users.begin()
               : std::find_if(users.begin(), users.end(),
                              [&](const User& one) { return may(one.uid); });
  }

  std::array<std::list<User>, kViewers + 1> ranks_;
  std::size_t size_ = 0;
};

}  // namespace mauve::daemon
