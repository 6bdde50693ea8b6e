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
    auto& users =
        *std::find_if(ranks_.begin(), ranks_.end(), [](const auto& rank) { return !rank.empty(); });
    auto& items = users.front().items;
    Item item = std::move(items.front());
    items.pop_front();
    --size_;
    if (items.empty()) {
      users.pop_front();
    } else {
      users.splice(users.end(), users, users.begin());
    }
    return item;
  }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct User {
    uid_t uid;
    std::deque<Item> items;  ///< never empty
  };

  static std::size_t rank_of(server::Role role) {
    if (role == server::Role::none) {
      return 0;
    }
    return role >= server::Role::operator_ ? 1 : 2;
  }

  std::array<std::list<User>, 3> ranks_;
  std::size_t size_ = 0;
};

}  // namespace mauve::daemon
