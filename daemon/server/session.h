// SPDX-License-Identifier: LGPL-3.0-or-later
/// One client: lines in, answers and notifications out, and the patience we have with it.
#pragma once

#include <utility>  // Boost.Asio 1.74 needs it and does not include it

#include <array>
#include <boost/asio/local/stream_protocol.hpp>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "protocol/framing.h"
#include "server/dispatcher.h"
#include "server/limits.h"
#include "server/rate.h"
#include "server/turns.h"

namespace mauve::server {

/// The objects that all sessions of a server share; they outlive the sessions.
struct SessionContext {
  const Limits& limits;
  Dispatcher& dispatcher;
  RateLimiter& rate;
  Turns& turns;
  std::function<void(std::uint64_t client, const std::string& reason)> on_end;
};

/// Lives as long as an operation of its socket is pending or the server knows it. [io]
class Session : public std::enable_shared_from_this<Session> {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;
  using Clock = std::chrono::steady_clock;

  Session(Socket socket, Caller caller, SessionContext& context);

  /// Makes the outbox, greets, begins to read.
  void start();
  /// Disconnects and notifies the server; the second time does nothing.
  void end(const std::string& reason);
  /// Ends it for another client: a last line has the reason.
  void displace(const Error& why);
  /// It has its first answer and asks nothing now: another client may have its place.
  [[nodiscard]] bool idle();
  /// Ends the session if the client has used up our patience.
  void check_patience(Clock::time_point now);
  /// No request is read any more; ends when all answers are sent.
  void finish();

  [[nodiscard]] const Caller& caller() const { return caller_; }

 private:
  void read();
  void on_read(const boost::system::error_code& error, std::size_t size);
  void serve_lines();
  void serve_in_turn(std::string line);
  void serve(const std::string& line);
  void dispatch(protocol::Request request);
  void turn_down(const protocol::Method& method, protocol::Request request,
                 const protocol::Fault& fault);
  void answer(const protocol::Json& message);
  void queue(std::string line);
  void write();
  void send();
  void on_sent(const boost::system::error_code& error, std::size_t size);
  void end_if_done();
  [[nodiscard]] std::string impatience(Clock::time_point now) const;
  [[nodiscard]] bool has_enough() const;
  [[nodiscard]] std::size_t unsent() const;
  [[nodiscard]] bool hung_up();

  Socket socket_;
  Caller caller_;
  SessionContext& context_;
  protocol::LineFramer framer_;
  std::array<char, 16 * 1024> buffer_{};
  std::deque<std::string> out_;  ///< answers that wait
  std::string sending_;          ///< the line on its way, empty for none
  std::size_t sent_ = 0;         ///< of it
  std::size_t out_bytes_ = 0;    ///< of both
  std::size_t in_flight_ = 0;
  bool reading_ = false;
  bool waits_ = false;        ///< for its turn to serve a line
  bool input_ended_ = false;  ///< half-closed, overlong line, or finish(): nothing more is read
  bool leaving_ = false;      ///< finish(): subscriptions do not count any more
  bool overlong_ = false;
  bool ended_ = false;
  bool heard_ = false;       ///< a first byte came
  bool answered_ = false;    ///< a first request
  Clock::time_point since_;  ///< last request or answer
  Clock::time_point partial_since_;
  Clock::time_point progress_;  ///< last byte the client took
};

}  // namespace mauve::server
