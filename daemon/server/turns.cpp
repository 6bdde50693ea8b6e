// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/turns.h"

#include <boost/asio/post.hpp>

namespace mauve::server {

void Turns::take(std::function<void()> work) {
  waiting_.push_back(std::move(work));
  if (waiting_.size() == 1) {
    boost::asio::post(io_, [this] { next(); });
  }
}

/// The piece stays at the front while it is done, so that take() does not begin a second row.
void Turns::next() {
  waiting_.front()();
  waiting_.pop_front();
  if (!waiting_.empty()) {
    boost::asio::post(io_, [this] { next(); });
  }
}

}  // namespace mauve::server
