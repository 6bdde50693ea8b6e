// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/server.h"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <future>

#include "base/mutex.h"
#include "base/thread_role.h"

namespace mauve::server {

namespace asio = boost::asio;
using logging::Event;

namespace {

constexpr std::chrono::milliseconds kSweep{200};
constexpr std::chrono::seconds kLooksAgain{1};

std::int64_t number(std::uint64_t value) { return static_cast<std::int64_t>(value); }

/// Often enough for the shortest patience.
std::chrono::milliseconds sweep_period(const Limits& limits) {
  const auto shortest =
      std::min({limits.first_byte, limits.idle, limits.half_request, limits.stalled});
  return std::clamp(shortest / 4, std::chrono::milliseconds(5), kSweep);
}

}  // namespace

Server::Server(ServerOptions options, Dispatcher& dispatcher, logging::Log& log)
    : options_(std::move(options)),
      dispatcher_(dispatcher),
      log_(log),
      work_(io_.get_executor()),
      acceptor_(io_),
      sweeper_(io_),
      rate_(options_.limits.mutations_per_second),
      context_{
          options_.limits, dispatcher_, rate_, turns_,
          [this](std::uint64_t client, const std::string& reason) { on_end(client, reason); }} {}

Server::~Server() { stop(std::chrono::milliseconds(0)); }

Status Server::open(Endpoint endpoint) {
  endpoint_.emplace(std::move(endpoint));
  boost::system::error_code error;
  acceptor_.assign(Protocol(), endpoint_->release_listener(), error);
  if (error) {
    return refuse({Errc::system, "socket_failed"}, endpoint_->path().string(), error.message());
  }
  log_.write(Event::listening, {{"socket", endpoint_->path().string()}});
  return ok();
}

void Server::start() {
  accept();
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::io);
    io_.run();
  });
}

void Server::stop(std::chrono::milliseconds grace) {
  if (thread_.joinable()) {
    auto empty = std::make_shared<std::promise<void>>();
    auto emptied = empty->get_future();
    asio::post(io_, [this, empty, grace] {
      closing_ = true;
      boost::system::error_code ignored;
      acceptor_.close(ignored);
      const auto sessions = sessions_;
      for (const auto& [id, session] : sessions) {
        grace.count() > 0 ? session->finish() : session->end("the daemon ends");
      }
      empty->set_value();
    });
    emptied.wait();
    const auto until = std::chrono::steady_clock::now() + grace;
    while (!clients().empty() && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    io_.stop();
    thread_.join();
  }
  // Nothing runs on [io] any more: this thread may end the sessions that are left.
  const auto late = sessions_;
  for (const auto& [id, session] : late) {
    session->end("the daemon ends");
  }
  endpoint_.reset();
}

void Server::post(std::function<void()> job) { asio::post(io_, std::move(job)); }

std::vector<ClientInfo> Server::clients() const {
  const MutexLock lock(clients_mutex_);
  std::vector<ClientInfo> out;
  for (const auto& [id, client] : clients_) {
    out.push_back(client);
  }
  return out;
}

void Server::accept() {
  if (closing_ || std::exchange(accepting_, true)) {
    return;
  }
  acceptor_.async_accept([this](const boost::system::error_code& error, Protocol::socket socket) {
    on_accept(error, std::move(socket));
  });
}

void Server::on_accept(const boost::system::error_code& error, Protocol::socket socket) {
  accepting_ = false;
  if (closing_ || error == asio::error::operation_aborted) {
    return;
  }
  const bool exhausted = error == asio::error::no_descriptors || error == asio::error::no_memory ||
                         error == asio::error::no_buffer_space ||
                         error == boost::system::errc::too_many_files_open_in_system;
  if (exhausted) {
    return pause_accept();
  }
  if (!error) {
    resume_accept();
    admit(std::move(socket));
  }
  accept();
}

/// The listening socket stays readable while no client can be accepted: asking again at once would
/// spin. sweep() and every session that ends try again.
void Server::pause_accept() {
  if (!paused_) {
    log_.write(Event::accept_paused);
  }
  paused_ = true;
  sweep();
}

void Server::resume_accept() {
  if (paused_) {
    paused_ = false;
    log_.write(Event::accept_resumed);
  }
}

Role Server::role_for(const Peer& peer) {
  const auto role = role_of(peer, options_.roles);
  const auto now = std::chrono::steady_clock::now();
  if (role != Role::none || !options_.look_again || now - looked_again_ < kLooksAgain) {
    return role;
  }
  looked_again_ = now;
  options_.roles = options_.look_again();
  return role_of(peer, options_.roles);
}

void Server::admit(Protocol::socket socket) {
  auto peer = peer_of(socket.native_handle());
  if (!peer) {
    return;
  }
  const auto role = role_for(*peer);
  const auto entry = entry_of(*peer, role);
  if (!entry) {
    return turn_away(std::move(socket), *peer, entry.error());
  }
  if (entry->displaced != 0) {
    displace(entry->displaced, role);
  }
  Caller caller{next_client_++, std::move(*peer), role, nullptr, entry->only_urgent};
  const auto id = caller.client;
  log_.write(Event::client_connected, {{"client", number(id)},
                                       {"uid", number(caller.peer.uid)},
                                       {"pid", number(static_cast<std::uint64_t>(caller.peer.pid))},
                                       {"role", std::string(to_string(role))}});
  {
    const MutexLock lock(clients_mutex_);
    clients_[id] = {id, caller.peer, role, std::chrono::system_clock::now()};
  }
  auto session = std::make_shared<Session>(std::move(socket), std::move(caller), context_);
  sessions_[id] = session;
  session->start();
  sweep();
}

/// Viewers never keep an operator or admin out, and an operator or admin may stop the machine even
/// when all connection slots of this user are in use.
Result<Server::Entry> Server::entry_of(const Peer& peer, Role role) const {
  if (role == Role::none) {
    return refuse({Errc::not_permitted, "no_role"}, "uid " + std::to_string(peer.uid),
                  "this user has no role here",
                  "ask to be added to a group, then log in again: 'mauve-view' to look, 'mauve' to "
                  "change");
  }
  const auto& limits = options_.limits;
  const auto extra = peer.uid == 0 ? limits.reserved_for_root : 0;
  const Occupancy occupancy = occupancy_for(peer.uid);
  const bool may_stop = role >= Role::operator_;
  if (occupancy.ordinary_of_uid >= limits.clients_per_uid + extra) {
    if (may_stop) {
      return urgent_entry(occupancy);
    }
    return refuse({Errc::limit, "too_many_clients"}, "uid " + std::to_string(peer.uid),
                  "this user has too many connections", "close some; mauvectl list clients");
  }
  if (occupancy.ordinary < limits.clients + extra) {
    return Entry{};
  }
  if (const auto displaced = oldest_below(role); displaced != 0) {
    return Entry{false, displaced};
  }
  if (may_stop) {
    return urgent_entry(occupancy);
  }
  return refuse({Errc::limit, "too_many_clients"}, "clients", "too many clients are connected",
                "close some; operators, admins and root get the slots of viewers");
}

/// There is always one: that of the user's own client which may only stop, else that of the oldest
/// one when the reserve is used up. A stop that such a client has sent goes on without it.
Server::Entry Server::urgent_entry(const Occupancy& occupancy) const {
  if (occupancy.urgent_of_uid != 0) {
    return {true, occupancy.urgent_of_uid};
  }
  return {true, occupancy.urgent < options_.limits.reserved_for_stop ? 0 : occupancy.oldest_urgent};
}

Server::Occupancy Server::occupancy_for(uid_t uid) const {
  Occupancy occupancy;
  for (const auto& [client, session] : sessions_) {
    const auto& caller = session->caller();
    const bool same_uid = caller.peer.uid == uid;
    if (caller.only_urgent) {
      ++occupancy.urgent;
      occupancy.oldest_urgent = occupancy.oldest_urgent == 0 ? client : occupancy.oldest_urgent;
      occupancy.urgent_of_uid = same_uid ? client : occupancy.urgent_of_uid;
    } else {
      ++occupancy.ordinary;
      occupancy.ordinary_of_uid += same_uid ? 1 : 0;
    }
  }
  return occupancy;
}

/// The oldest client of the lowest role below this one that has an ordinary slot; 0: there is
/// none.
std::uint64_t Server::oldest_below(Role role) const {
  std::uint64_t found = 0;
  Role lowest = role;
  for (const auto& [client, session] : sessions_) {
    if (!session->caller().only_urgent && session->caller().role < lowest) {
      lowest = session->caller().role;
      found = client;
    }
  }
  return found;
}

void Server::displace(std::uint64_t client, Role by) {
  const auto session = sessions_.at(client);  // end() takes it out of the map
  session->end("all connection slots were in use, and a client of role " +
               std::string(to_string(by)) + " got this one");
}

void Server::turn_away(Protocol::socket socket, const Peer& peer, const Error& why) {
  if (refusals_.may_write(peer.uid, std::chrono::steady_clock::now())) {
    log_.write(Event::client_refused, {{"uid", number(peer.uid)}, {"reason", why.message}});
  }
  sweep();  // logs how many refusals have no line of their own
  const auto line =
      protocol::to_line(protocol::make_error(nullptr, protocol::fault_of(why))) + '\n';
  boost::system::error_code ignored;
  // A fresh socket has room for one line; if not, the client learns from the closed connection.
  socket.non_blocking(true, ignored);
  socket.send(asio::buffer(line), 0, ignored);
}

void Server::report_counted_refusals() {
  for (const auto& [uid, count] : refusals_.take_counted(std::chrono::steady_clock::now())) {
    log_.write(Event::clients_refused, {{"uid", number(uid)}, {"count", number(count)}});
  }
}

void Server::on_end(std::uint64_t client, const std::string& reason) {
  log_.write(Event::client_gone, {{"client", number(client)}, {"reason", reason}});
  sessions_.erase(client);
  {
    const MutexLock lock(clients_mutex_);
    clients_.erase(client);
  }
  if (paused_) {
    accept();
  }
}

/// Runs while there is a session to watch: an idle daemon does not wake up.
void Server::sweep() {
  if (std::exchange(sweeping_, true)) {
    return;
  }
  sweeper_.expires_after(sweep_period(options_.limits));
  sweeper_.async_wait([this](const boost::system::error_code& error) {
    sweeping_ = false;
    if (error) {
      return;
    }
    const auto now = Session::Clock::now();
    const auto sessions = sessions_;  // check_patience() may take one out
    for (const auto& [id, session] : sessions) {
      session->check_patience(now);
    }
    report_counted_refusals();
    if (paused_) {
      accept();
    }
    if (paused_ || !sessions_.empty() || !refusals_.empty()) {
      sweep();
    }
  });
}

}  // namespace mauve::server
