// SPDX-License-Identifier: LGPL-3.0-or-later
/// The interface through which the server calls the daemon.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "protocol/methods.h"
#include "server/outbox.h"
#include "server/peer.h"

namespace mauve::server {

/// The client that sent a request. A copy may be kept; the outbox stays valid (and deaf) after the
/// client has gone.
struct Caller {
  std::uint64_t client = 0;  ///< number of the connection, never used again
  Peer peer;
  Role role = Role::none;
  std::shared_ptr<Outbox> outbox;
  /// Why it may only stop, confirm, undo and ping; empty: it may call all that its role permits.
  std::string_view only_urgent_since = {};

  [[nodiscard]] bool only_urgent() const { return !only_urgent_since.empty(); }
};

using Outcome = std::variant<protocol::Json, protocol::Fault>;
/// Brings the answer to the client. Called at most once, from any thread, at any time: it does not
/// wait, and does nothing when the client has gone.
using Reply = std::function<void(Outcome)>;

/// Serves requests. All functions are called on [io] and must not wait.
class Dispatcher {
 public:
  virtual ~Dispatcher() = default;

  /// The parameters of the greeting; the server adds "role" and "limits".
  virtual protocol::Json hello() = 0;

  /// `method` is the row of the request's method, its arguments are checked against it. The role of
  /// the caller is not checked yet.
  virtual void dispatch(const Caller& caller, const protocol::Method& method,
                        protocol::Request request, Reply reply) = 0;

  /// A mutation was refused before it came to dispatch(): its arguments are wrong, or there are too
  /// many. The client has its answer.
  virtual void refused(const Caller& /*caller*/, const protocol::Method& /*method*/,
                       protocol::Request /*request*/, const protocol::Fault& /*fault*/) {}

  /// The client has gone: its subscriptions may end.
  virtual void gone(std::uint64_t client) = 0;
};

}  // namespace mauve::server
