// SPDX-License-Identifier: LGPL-3.0-or-later
/// The admin socket: accepts clients and runs their sessions on one thread that never waits.
#pragma once

#include <utility>  // Boost.Asio 1.74 needs it and does not include it

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "log/log.h"
#include "server/dispatcher.h"
#include "server/doors.h"
#include "server/limits.h"
#include "server/refusals.h"
#include "server/session.h"
#include "server/slots.h"

namespace mauve::server {

/// One row of client.list.
struct ClientInfo {
  std::uint64_t client = 0;
  Peer peer;
  Role role = Role::none;
  std::chrono::system_clock::time_point since;
  bool only_urgent = false;
};

struct ServerOptions {
  Limits limits;
  RoleRules roles;
  /// Asked when a user has no role, at most once a second: his group may be new. None: never asked.
  std::function<RoleRules()> look_again = {};
  /// Called on [io] at its start, and after each piece of its work. None: nothing is called.
  std::function<void()> after_work = {};
};

class Server {
 public:
  /// Dispatcher and log outlive the server.
  Server(ServerOptions options, Dispatcher& dispatcher, logging::Log& log);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Takes over the listening sockets. Clients that connected to them before have waited. [main]
  Status open(Endpoint endpoint);
  /// Starts the [io] thread: clients are served. [main]
  void start();
  /// Lets no one in any more, gives the clients `grace` to take their last answers, then ends the
  /// [io] thread and removes the sockets. The second time does nothing. [main]
  void stop(std::chrono::milliseconds grace);

  /// [any] Removes the sockets while the process ends by force.
  void remove_names() const { doors_.remove_names(); }

  /// [any] Runs `job` on [io].
  void post(std::function<void()> job);
  /// [any] The clients that are connected.
  [[nodiscard]] std::vector<ClientInfo> clients() const;

 private:
  using Protocol = boost::asio::local::stream_protocol;

  void admit(Protocol::socket socket, Way way);
  [[nodiscard]] Role role_for(const Peer& peer);
  [[nodiscard]] std::vector<Slot> slots() const;
  [[nodiscard]] bool make_room();
  void displace(std::uint64_t client, Role by);
  void turn_away(Protocol::socket socket, const Peer& peer, const Error& why);
  void report_counted_refusals();
  void on_end(std::uint64_t client, const std::string& reason);
  void sweep();

  ServerOptions options_;
  std::chrono::steady_clock::time_point looked_again_;  // [io]
  Dispatcher& dispatcher_;
  logging::Log& log_;
  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
  Doors doors_;
  boost::asio::steady_timer sweeper_;
  RateLimiter rate_;
  Turns turns_{io_};
  Refusals refusals_;  ///< of connections
  SessionContext context_;
  std::map<std::uint64_t, std::shared_ptr<Session>> sessions_;  ///< [io]
  std::uint64_t next_client_ = 1;
  bool sweeping_ = false;
  bool closing_ = false;
  mutable Mutex clients_mutex_;
  std::map<std::uint64_t, ClientInfo> clients_
      MAUVE_GUARDED_BY(clients_mutex_);  ///< a copy for other threads
  std::thread thread_;
};

}  // namespace mauve::server
