// SPDX-License-Identifier: LGPL-3.0-or-later
/// The order in which clients read long requests.
#pragma once

#include <utility>  // Boost.Asio 1.74 needs it and does not include it

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>

namespace mauve::server {

/// Long work of sessions on [io]: one piece between two looks at all sockets, in the order of its
/// coming. A stop waits for one or two pieces, however many clients send them. [io]
class Turns {
 public:
  explicit Turns(boost::asio::io_context& io) : io_(io) {}

  /// Does it when its turn comes; never, when the server ends before.
  void take(std::function<void()> work);

 private:
  void next();

  boost::asio::io_context& io_;
  std::deque<std::function<void()>> waiting_;
};

}  // namespace mauve::server
