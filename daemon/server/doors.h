// SPDX-License-Identifier: LGPL-3.0-or-later
/// The listening sockets: they let clients in also when the process has no descriptor left, and are
/// made anew when something took them away.
#pragma once

#include <utility>  // Boost.Asio 1.74 needs it and does not include it

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <optional>

#include "log/log.h"
#include "server/endpoint.h"
#include "server/reserve.h"

namespace mauve::server {

/// [io], except where a function says otherwise.
class Doors {
 public:
  using Protocol = boost::asio::local::stream_protocol;
  using OnClient = std::function<void(Protocol::socket, Way)>;

  /// `make_room` is called when a client waits and no descriptor is left: true if a session ended.
  Doors(boost::asio::io_context& io, logging::Log& log, OnClient on_client,
        std::function<bool()> make_room);

  /// [main] Takes over the listening sockets. Clients that connected to them before have waited.
  [[nodiscard]] Status open(Endpoint endpoint);
  /// [main] before [io] runs.
  void start();
  /// Lets no one in any more.
  void close();
  /// [main] behind [io]: removes the sockets.
  void remove() { endpoint_.reset(); }
  /// [any] The same while the process ends by force.
  void remove_names() const {
    if (endpoint_) {
      endpoint_->remove_names();
    }
  }

  /// A client went: its descriptor may be used for the next one.
  void on_client_gone();
  /// Clients are let in with descriptors of the reserve only.
  [[nodiscard]] bool scarce() const { return scarce_; }

 private:
  struct Door {
    explicit Door(boost::asio::io_context& io, Way its_way) : acceptor(io), way(its_way) {}
    Protocol::acceptor acceptor;
    Way way;
    bool open = false;
    bool accepting = false;
    bool lost = false;     ///< reported: the socket is gone
    bool refused = false;  ///< reported: it cannot be made anew
  };

  [[nodiscard]] Status adopt(Door& door);
  void accept(Door& door);
  void on_accept(Door& door, const boost::system::error_code& error, Protocol::socket socket);
  void accept_from_reserve(Door& door);
  void refill();
  void look_each_while();
  void look(Door& door);

  boost::asio::io_context& io_;
  logging::Log& log_;
  OnClient on_client_;
  std::function<bool()> make_room_;
  std::optional<Endpoint> endpoint_;
  std::array<Door, kWays.size()> doors_{Door(io_, Way::all), Door(io_, Way::stop)};
  boost::asio::steady_timer timer_{io_};
  Reserve reserve_;
  bool scarce_ = false;
  bool closed_ = false;
};

}  // namespace mauve::server
