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
      doors_(
          io_, log_, [this](Protocol::socket socket, Way way) { admit(std::move(socket), way); },
          [this] { return make_room(); }),
      sweeper_(io_),
      rate_(options_.limits.mutations_per_second),
      context_{
          options_.limits, dispatcher_, rate_, turns_,
          [this](std::uint64_t client, const std::string& reason) { on_end(client, reason); }} {}

Server::~Server() { stop(std::chrono::milliseconds(0)); }

Status Server::open(Endpoint endpoint) { return doors_.open(std::move(endpoint)); }

void Server::start() {
  doors_.start();
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::io);
    do {
      if (options_.after_work) {
        options_.after_work();
      }
    } while (io_.run_one() > 0);
  });
}

void Server::stop(std::chrono::milliseconds grace) {
  if (thread_.joinable()) {
    auto empty = std::make_shared<std::promise<void>>();
    auto emptied = empty->get_future();
    asio::post(io_, [this, empty, grace] {
      closing_ = true;
      doors_.close();
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
  doors_.remove();
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

Role Server::role_for(const Peer& peer) {
  const auto role = role_of(peer, options_.roles);
  const auto now = std::chrono::steady_clock::now();
  // The list of groups cannot be read without a descriptor.
  if (role != Role::none || !options_.look_again || doors_.scarce() ||
      now - looked_again_ < kLooksAgain) {
    return role;
  }
  looked_again_ = now;
  options_.roles = options_.look_again();
  return role_of(peer, options_.roles);
}

void Server::admit(Protocol::socket socket, Way way) {
  auto peer = peer_of(socket.native_handle());
  if (!peer) {
    return;
  }
  const auto role = role_for(*peer);
  const auto since = way == Way::stop  ? kWayOfStops
                     : doors_.scarce() ? kNoDescriptor
                                       : std::string_view();
  const auto entry = entry_for(*peer, role, since, options_.limits, slots());
  if (!entry) {
    return turn_away(std::move(socket), *peer, entry.error());
  }
  if (entry->displaced != 0) {
    displace(entry->displaced, role);
  }
  Caller caller{next_client_++, std::move(*peer), role, nullptr, entry->only_urgent_since};
  const auto id = caller.client;
  log_.write(Event::client_connected, {{"client", number(id)},
                                       {"uid", number(caller.peer.uid)},
                                       {"pid", number(static_cast<std::uint64_t>(caller.peer.pid))},
                                       {"role", std::string(to_string(role))}});
  {
    const MutexLock lock(clients_mutex_);
    clients_[id] = {id, caller.peer, role, std::chrono::system_clock::now(), caller.only_urgent()};
  }
  auto session = std::make_shared<Session>(std::move(socket), std::move(caller), context_);
  sessions_[id] = session;
  session->start();
  sweep();
}

std::vector<Slot> Server::slots() const {
  std::vector<Slot> slots;
  for (const auto& [client, session] : sessions_) {
    const auto& caller = session->caller();
    slots.push_back({client, caller.peer.uid, caller.role, caller.only_urgent(), session->idle()});
  }
  return slots;
}

/// For a client that waits while the process has no descriptor.
bool Server::make_room() {
  const auto client = oldest_idle_stop(slots());
  if (client != 0) {
    displace(client, Role::operator_);
  }
  return client != 0;
}

void Server::displace(std::uint64_t client, Role by) {
  const auto session = sessions_.at(client);  // displace() takes it out of the map
  session->displace(refuse({Errc::limit, "too_many_clients"},
                           "uid " + std::to_string(session->caller().peer.uid),
                           "all connection slots were in use, and a client of role " +
                               std::string(to_string(by)) + " got this one",
                           "connect again; mauvectl list clients shows who is connected"));
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
  doors_.on_client_gone();
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
    if (!sessions_.empty() || !refusals_.empty()) {
      sweep();
    }
  });
}

}  // namespace mauve::server
