// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/client.h"

#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>

#include "protocol/methods.h"
#include "protocol/socket_path.h"

namespace mauve::ctl {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using protocol::fault_of;
using protocol::ServerMessage;
using protocol::wrong_use;

// Answers may be longer than requests: the export of a large system.
constexpr std::size_t kLongestAnswer = 64 * 1024 * 1024;
constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

bool is_no_socket(const std::string& path) {
  struct stat its {};
  return stat(path.c_str(), &its) == 0 && !S_ISSOCK(its.st_mode);
}

Fault cannot_connect(const std::string& path, const error_code& error) {
  if (is_no_socket(path)) {
    return fault_of(protocol::kUnreachable, path + " is no socket, so no mauved answers there",
                    path, how_to_reach(path));
  }
  if (error == asio::error::no_permission || error == asio::error::access_denied) {
    return fault_of(refuse({Errc::not_permitted, "socket_not_permitted"}, path,
                           "not permitted to open the socket of mauved",
                           how_to_be_permitted(path)));
  }
  std::string message = "cannot connect to mauved: " + error.message();
  if (error == error_code(ENOENT, boost::system::system_category())) {
    message = "there is no socket at " + path + ", so no mauved answers there";
  } else if (error == asio::error::connection_refused) {
    message = "nobody listens on the socket " + path + ", so no mauved answers there";
  } else if (error == asio::error::try_again || error == asio::error::timed_out) {
    message = "mauved is there, but so many clients connect that none of them gets in in time";
  }
  return fault_of(protocol::kUnreachable, std::move(message), path, how_to_reach(path));
}

/// The connected socket, or what went wrong. Waits in the queue of the kernel, where clients that
/// connect in a loop do not get in front.
int open_connection(const std::string& path, Client::Deadline deadline, error_code& error) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  int rc = -1;
  do {
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(
        deadline - std::chrono::steady_clock::now());
    const auto wait = std::max<std::int64_t>(left.count(), 1'000);
    const timeval limit{wait / 1'000'000, wait % 1'000'000};
    setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    rc = ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  } while (rc != 0 && errno == EINTR && std::chrono::steady_clock::now() < deadline);
  if (rc == 0) return fd;
  error = error_code(errno, boost::system::system_category());
  if (fd >= 0) ::close(fd);
  return -1;
}

/// Whether somebody listens at the socket, without waiting for it.
bool is_listening(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int rc = ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const bool listens = rc == 0 || errno == EAGAIN;
  ::close(fd);
  return listens;
}

/// Before anything is believed or sent: an impostor would answer that all components stopped.
std::optional<Fault> distrust_of_listener(const std::string& path, int socket) {
  ucred who{};
  socklen_t size = sizeof who;
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) return std::nullopt;
  if (protocol::may_be_mauved(path, who.uid)) return std::nullopt;
  return fault_of(refuse({Errc::not_permitted, "listener_not_trusted"}, path,
                         "a process of user " + std::to_string(who.uid) +
                             " listens there, who is neither root nor you nor the owner of a "
                             "directory that only its owner may write: nothing was sent to it",
                         "name the socket of the right mauved: --socket FILE"));
}

bool speaks_our_version(const Json& greeting) {
  const auto versions = greeting.find("protocol");
  return versions != greeting.end() && versions->is_array() &&
         std::find(versions->begin(), versions->end(), protocol::kVersion) != versions->end();
}

}  // namespace

std::string how_to_be_permitted(const std::string& path) {
  struct stat its {};
  const bool found_it = stat(path.c_str(), &its) == 0;
  if (!found_it || (its.st_gid != getegid() && group_member(its.st_gid) == 0)) {
    return "ask to be added to a group, then log in again: 'mauve-view' to look, 'mauve' to change";
  }
  const group* found = getgrgid(its.st_gid);
  return "this user is in the group '" +
         (found != nullptr ? std::string(found->gr_name) : std::to_string(its.st_gid)) +
         "' of the socket already, so its mode or its access list is wrong: getfacl " + path;
}

std::string how_to_reach(const std::string& path, const std::string& service) {
  if (path != service && (access(service.c_str(), F_OK) == 0 || errno == EACCES)) {
    return "if no mauved of yours runs (pgrep -a mauved), start one (mauved ARCHITECTURE.json), or "
           "ask that of the system service: export MAUVE_SOCKET=" +
           service;
  }
  return "look at the service (systemctl status mauved, journalctl -u mauved); if no mauved runs "
         "(pgrep -a mauved; it makes a socket that was removed anew within a second), start it "
         "(systemctl start mauved, or mauved ARCHITECTURE.json), or choose another --socket";
}

struct Client::Connection {
  asio::io_context io;
  asio::local::stream_protocol::socket socket{io};
  protocol::LineFramer framer{kLongestAnswer};
  std::array<char, 65536> buffer{};

  /// Runs the one operation that was started; false when the deadline passed (it is cancelled).
  bool finish(Deadline deadline) {
    io.restart();
    io.run_until(deadline);
    if (io.stopped()) return true;
    error_code ignored;
    socket.cancel(ignored);
    io.run();
    return false;
  }
};

Client::Client(std::string socket_path, std::chrono::nanoseconds greeting_timeout)
    : path_(std::move(socket_path)),
      greeting_timeout_(greeting_timeout),
      connection_(std::make_unique<Connection>()) {}

Client::~Client() = default;

std::optional<Fault> Client::connect(bool urgent) {
  if (path_.empty() || path_.size() > kLongestPath) {
    return wrong_use(
        "usage_socket_path",
        "the path of a socket has 1 to " + std::to_string(kLongestPath) + " characters", path_);
  }
  const Deadline deadline = std::chrono::steady_clock::now() + greeting_timeout_;
  const std::string of_stops = path_ + protocol::kStopSuffix;
  // An older mauved has none, and a user may lack the right to it.
  if (urgent && of_stops.size() <= kLongestPath && !connect_to(of_stops, deadline)) {
    return std::nullopt;
  }
  return connect_to(path_, deadline);
}

std::optional<Fault> Client::connect_to(const std::string& path, Deadline deadline) {
  connection_ = std::make_unique<Connection>();
  greeting_ = Json::object();
  error_code error;
  const int fd = open_connection(path, deadline, error);
  if (fd < 0) return cannot_connect(path_, error);
  connection_->socket.assign(asio::local::stream_protocol(), fd);
  if (auto distrust = distrust_of_listener(path, fd)) return distrust;

  auto line = read_line(deadline);
  if (auto* text = std::get_if<std::string>(&line)) return accept_greeting(*text);
  Fault fault = std::get<Fault>(std::move(line));
  if (fault.name != "timed_out") return fault;
  return fault_of(protocol::kUnreachable, "the server did not greet", path_,
                  "is it mauved? if so it hangs: systemctl status mauved");
}

std::optional<Fault> Client::accept_greeting(std::string_view line) {
  auto message = protocol::parse_server_message(line);
  if (!message) return bad_answer(message.error().message);
  if (auto* response = std::get_if<protocol::Response>(&*message)) {
    if (auto* fault = std::get_if<Fault>(&response->outcome)) return std::move(*fault);
  }
  auto* hello = std::get_if<Notification>(&*message);
  if (hello == nullptr || hello->method != "hello" || !hello->params.is_object()) {
    return bad_answer("the server did not greet as mauved does");
  }
  greeting_ = std::move(hello->params);
  if (speaks_our_version(greeting_)) return std::nullopt;
  return fault_of(protocol::kBadAnswer,
                  "the daemon does not speak protocol " + std::to_string(protocol::kVersion), path_,
                  "use the mauvectl that was installed with it");
}

std::variant<Json, Fault> Client::call(std::string_view method, const Json& params,
                                       std::chrono::nanoseconds timeout) {
  const Deadline deadline = std::chrono::steady_clock::now() + timeout;
  const auto* known = protocol::find_method(method);
  const bool changes = known != nullptr && known->mutation();
  const auto lost = [&](Fault fault) {
    if (changes) fault.state = "unknown";
    return fault;
  };
  const std::string line = protocol::to_line(protocol::make_request(++last_id_, method, params));
  if (line.size() > protocol::kMaxLine) {
    return fault_of(refuse({Errc::limit, "request_too_long"}, std::string(method),
                           "the request is longer than 1 MiB, so it was not sent",
                           "send less at a time: a smaller file, or fewer steps"));
  }
  if (auto fault = send(line + "\n", deadline)) return lost(std::move(*fault));
  while (true) {
    auto message = read_message(deadline);
    if (auto* fault = std::get_if<Fault>(&message)) return lost(std::move(*fault));
    auto& content = std::get<ServerMessage>(message);
    if (auto* notification = std::get_if<Notification>(&content)) {
      notifications_.push_back(std::move(*notification));
      continue;
    }
    auto& response = std::get<protocol::Response>(content);
    // An error without id is about the connection, so it is about this request as well.
    if (response.id == last_id_ || response.id.is_null()) return std::move(response.outcome);
  }
}

std::variant<Notification, Fault> Client::next(Deadline deadline) {
  while (notifications_.empty()) {
    auto message = read_message(deadline);
    if (auto* fault = std::get_if<Fault>(&message)) return std::move(*fault);
    auto& content = std::get<ServerMessage>(message);
    if (auto* notification = std::get_if<Notification>(&content)) {
      notifications_.push_back(std::move(*notification));
      continue;
    }
    // An error without id is about the connection.
    auto& response = std::get<protocol::Response>(content);
    auto* fault = std::get_if<Fault>(&response.outcome);
    if (fault != nullptr && response.id.is_null()) return std::move(*fault);
  }
  Notification first = std::move(notifications_.front());
  notifications_.pop_front();
  return first;
}

std::variant<ServerMessage, Fault> Client::read_message(Deadline deadline) {
  auto line = read_line(deadline);
  if (auto* fault = std::get_if<Fault>(&line)) return std::move(*fault);
  auto message = protocol::parse_server_message(std::get<std::string>(line));
  if (!message) return bad_answer(message.error().message);
  return std::move(*message);
}

std::variant<std::string, Fault> Client::read_line(Deadline deadline) {
  while (true) {
    if (auto line = connection_->framer.next()) return std::move(*line);
    error_code error;
    std::size_t received = 0;
    connection_->socket.async_read_some(asio::buffer(connection_->buffer),
                                        [&](const error_code& result, std::size_t size) {
                                          error = result;
                                          received = size;
                                        });
    if (!connection_->finish(deadline)) {
      return fault_of(refuse({Errc::timed_out, "answer_late"}, path_,
                             "the daemon did not answer in time",
                             "wait longer with --timeout, look with: mauvectl status"));
    }
    if (error) return gone();
    const std::string_view bytes(connection_->buffer.data(), received);
    if (Status fed = connection_->framer.feed(bytes); !fed) return bad_answer(fed.error().message);
  }
}

std::optional<Fault> Client::send(const std::string& line, Deadline deadline) {
  error_code error;
  asio::async_write(connection_->socket, asio::buffer(line),
                    [&](const error_code& result, std::size_t) { error = result; });
  if (!connection_->finish(deadline)) {
    return fault_of(refuse({Errc::timed_out, "request_not_read"}, path_,
                           "the daemon does not take the request", "look with: mauvectl status"));
  }
  // A daemon that refuses may close before it has read everything: its reason can still be read.
  if (error && error != asio::error::broken_pipe) return gone();
  return std::nullopt;
}

Fault Client::gone() const {
  if (!greeting_.empty() && is_listening(path_)) {
    return fault_of(protocol::kUnreachable, "mauved runs, but closed this connection", path_,
                    "try again; look why: mauvectl logs --level debug");
  }
  const bool half = connection_->framer.partial();
  return fault_of(protocol::kUnreachable,
                  half ? "mauved went away in the middle of a line" : "mauved went away", path_,
                  "look why: journalctl -u mauved, mauvectl status");
}

Fault Client::bad_answer(std::string message) const {
  return fault_of(protocol::kBadAnswer, std::move(message), path_,
                  "is this the socket of mauved? choose another with --socket PATH");
}

}  // namespace mauve::ctl
