// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/doors.h"

#include <poll.h>

#include <cerrno>
#include <chrono>

namespace mauve::server {

namespace asio = boost::asio;
using boost::system::error_code;
using logging::Event;

namespace {

/// A socket that is gone is noticed after a second at the latest.
constexpr std::chrono::milliseconds kLooks{400};

bool is_exhausted(const error_code& error) {
  return error == asio::error::no_descriptors || error == asio::error::no_memory ||
         error == asio::error::no_buffer_space ||
         error == boost::system::errc::too_many_files_open_in_system;
}

/// Of one client only; any other error is of the listening socket.
bool is_passing(const error_code& error) {
  return error == asio::error::connection_aborted || error == asio::error::interrupted ||
         error == asio::error::would_block || error == asio::error::operation_aborted;
}

/// Somebody shut the listening socket down or closed it.
bool is_deaf(int listener) {
  pollfd its{listener, POLLIN | POLLRDHUP, 0};
  return poll(&its, 1, 0) > 0 && (its.revents & (POLLRDHUP | POLLHUP | POLLERR | POLLNVAL)) != 0;
}

}  // namespace

Doors::Doors(asio::io_context& io, logging::Log& log, OnClient on_client,
             std::function<bool()> make_room)
    : io_(io), log_(log), on_client_(std::move(on_client)), make_room_(std::move(make_room)) {}

Status Doors::open(Endpoint endpoint) {
  endpoint_.emplace(std::move(endpoint));
  for (auto& door : doors_) {
    if (auto adopted = adopt(door); !adopted) {
      return adopted;
    }
  }
  log_.write(Event::listening, {{"socket", endpoint_->path().string()}});
  return ok();
}

Status Doors::adopt(Door& door) {
  const int listener = endpoint_->release_listener(door.way);
  if (listener < 0) {
    return ok();
  }
  error_code error;
  door.acceptor.close(error);
  door.acceptor.assign(Protocol(), listener, error);
  if (!error) {
    door.acceptor.non_blocking(true, error);
  }
  if (error) {
    return refuse({Errc::system, "socket_failed"}, endpoint_->path(door.way).string(),
                  error.message());
  }
  door.open = true;
  return ok();
}

void Doors::start() {
  for (auto& door : doors_) {
    accept(door);
  }
  look_each_while();
}

void Doors::close() {
  closed_ = true;
  error_code ignored;
  timer_.cancel();
  for (auto& door : doors_) {
    door.acceptor.close(ignored);
  }
}

void Doors::accept(Door& door) {
  if (closed_ || !door.acceptor.is_open() || std::exchange(door.accepting, true)) {
    return;
  }
  door.acceptor.async_accept([this, &door](const error_code& error, Protocol::socket socket) {
    on_accept(door, error, std::move(socket));
  });
}

/// A listening socket that fails is left to look(): asking again at once would spin.
void Doors::on_accept(Door& door, const error_code& error, Protocol::socket socket) {
  door.accepting = false;
  if (closed_) {
    return;
  }
  if (is_exhausted(error)) {
    return accept_from_reserve(door);
  }
  if (!error) {
    refill();
    on_client_(std::move(socket), door.way);
  } else if (!is_passing(error)) {
    return;
  }
  accept(door);
}

/// Another thread may take the descriptor that is freed: hence the attempts. Without success each
/// client that goes, and each look, tries again.
void Doors::accept_from_reserve(Door& door) {
  if (!std::exchange(scarce_, true)) {
    log_.write(Event::accept_paused);
  }
  while (reserve_.spend() || make_room_()) {
    error_code error;
    Protocol::socket socket(io_);
    door.acceptor.accept(socket, error);
    if (is_exhausted(error)) {
      continue;
    }
    if (!error) {
      on_client_(std::move(socket), door.way);
    }
    refill();
    return accept(door);
  }
}

void Doors::refill() {
  reserve_.refill();
  if (reserve_.full() && std::exchange(scarce_, false)) {
    log_.write(Event::accept_resumed);
  }
}

void Doors::on_client_gone() {
  refill();
  for (auto& door : doors_) {
    accept(door);
  }
}

void Doors::look_each_while() {
  timer_.expires_after(kLooks);
  timer_.async_wait([this](const error_code& error) {
    if (error || closed_) {
      return;
    }
    refill();
    for (auto& door : doors_) {
      look(door);
      accept(door);
    }
    look_each_while();
  });
}

/// Clients that are connected keep their connections.
void Doors::look(Door& door) {
  if (!door.open || (endpoint_->is_there(door.way) && !is_deaf(door.acceptor.native_handle()))) {
    return;
  }
  const auto path = endpoint_->path(door.way).string();
  if (!std::exchange(door.lost, true)) {
    log_.write(Event::socket_lost, {{"socket", path}});
  }
  auto bound = endpoint_->bind_again(door.way);
  if (bound) {
    bound = adopt(door);
  }
  if (!bound) {
    if (!std::exchange(door.refused, true)) {
      log_.write(Event::socket_not_bound, {{"socket", path}, {"text", to_string(bound.error())}});
    }
    return;
  }
  door.lost = door.refused = false;
  log_.write(Event::socket_bound_again, {{"socket", path}});
}

}  // namespace mauve::server
