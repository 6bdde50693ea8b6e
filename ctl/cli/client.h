// SPDX-License-Identifier: LGPL-3.0-or-later
/// One connection to mauved: greeting, requests one at a time, notifications. One thread.
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "protocol/message.h"
#include "protocol/socket_path.h"

namespace mauve::ctl {

using protocol::Fault;
using protocol::Json;
using protocol::Notification;

/// The hint of a client that finds no mauved at the socket `path`. Names the socket `service` of
/// the system service when that exists, or may exist in a folder that this user may not read. A
/// client never takes that socket by itself: its user may have meant another robot.
[[nodiscard]] std::string how_to_reach(const std::string& path,
                                       const std::string& service = protocol::kServiceSocket);

/// The hint of a client that may not open the socket `path`. It names the group that the client
/// lacks. To a client in that group it names the command that shows the access list of the socket.
[[nodiscard]] std::string how_to_be_permitted(const std::string& path);

class Client {
 public:
  Client(std::string socket_path, std::chrono::nanoseconds greeting_timeout);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Connects and reads the greeting; may be called again after a fault. `urgent`: for stop,
  /// confirm and undo; their own socket comes first. Waits for room in the queue of the socket, in
  /// the order of coming. Returns nothing on success. Otherwise the Fault is unreachable,
  /// not_permitted or bad_answer, or the error that the server sends in place of its greeting.
  [[nodiscard]] std::optional<Fault> connect(bool urgent = false);

  /// Sends one request and waits for its answer; notifications that come before it are kept for
  /// next(). After a lost connection or a timeout the state after a mutation is "unknown".
  [[nodiscard]] std::variant<Json, Fault> call(std::string_view method, const Json& params,
                                               std::chrono::nanoseconds timeout);

  using Deadline = std::chrono::steady_clock::time_point;
  /// The next notification; by default waits as long as it takes. A Fault when the daemon goes
  /// away, "timed_out" when there is none before the deadline.
  [[nodiscard]] std::variant<Notification, Fault> next(Deadline deadline = Deadline::max());

  /// The greeting in which the daemon describes itself.
  [[nodiscard]] const Json& greeting() const { return greeting_; }

 private:
  struct Connection;

  std::optional<Fault> connect_to(const std::string& path, Deadline deadline);
  std::optional<Fault> accept_greeting(std::string_view line);
  std::variant<std::string, Fault> read_line(Deadline deadline);
  std::variant<protocol::ServerMessage, Fault> read_message(Deadline deadline);
  std::optional<Fault> send(const std::string& line, Deadline deadline);
  [[nodiscard]] Fault gone() const;
  [[nodiscard]] Fault bad_answer(std::string message) const;

  std::string path_;
  std::chrono::nanoseconds greeting_timeout_;
  std::unique_ptr<Connection> connection_;
  std::deque<Notification> notifications_;
  Json greeting_ = Json::object();
  std::int64_t last_id_ = 0;
};

}  // namespace mauve::ctl
