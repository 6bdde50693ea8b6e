// SPDX-License-Identifier: LGPL-3.0-or-later
/// A client that sends any bytes of a test, one by one if need be. For the socket of mauved.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "protocol/framing.h"
#include "protocol/message.h"

namespace mauve::test {

class RawClient {
 public:
  static constexpr std::chrono::milliseconds kPatience{60'000};

  explicit RawClient(const std::filesystem::path& socket) {
    fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socket.c_str(), sizeof address.sun_path - 1);
    connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  RawClient(RawClient&& other) noexcept
      : on_answer(std::move(other.on_answer)),
        fd_(std::exchange(other.fd_, -1)),
        connected_(other.connected_),
        framer_(std::move(other.framer_)) {}
  RawClient& operator=(RawClient&&) = delete;
  ~RawClient() { close(); }

  void close() {
    if (fd_ >= 0) {
      ::close(std::exchange(fd_, -1));
    }
  }
  void half_close() const { shutdown(fd_, SHUT_WR); }
  [[nodiscard]] bool connected() const { return connected_; }

  /// Called with the method and the result of each answer to ask().
  std::function<void(std::string_view, const protocol::Json&)> on_answer;

  [[nodiscard]] int fd() const { return fd_; }

  /// False when the other end has closed. Waits while the other end does not read.
  [[nodiscard]] bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const auto sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0) {
        return false;
      }
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// As much as goes without waiting; the number of bytes.
  [[nodiscard]] std::size_t send_some(std::string_view bytes) const {
    const auto sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    return sent < 0 ? 0 : static_cast<std::size_t>(sent);
  }

  /// The next line, or nothing: the other end closed, or kept silent for `limit`.
  [[nodiscard]] std::optional<std::string> line(std::chrono::milliseconds limit = kPatience) {
    for (;;) {
      if (auto next = framer_.next()) {
        return next;
      }
      if (!receive(limit)) {
        return std::nullopt;
      }
    }
  }

  /// The other end has closed, as the last look found.
  [[nodiscard]] bool ended() const { return ended_; }

  /// The next line as JSON; null when there is none.
  [[nodiscard]] protocol::Json json(std::chrono::milliseconds limit = kPatience) {
    const auto next = line(limit);
    if (!next) {
      return nullptr;
    }
    auto parsed = protocol::parse_json(*next);
    return parsed ? *parsed : protocol::Json(nullptr);
  }

  /// Sends a request and returns its answer, notifications left out.
  [[nodiscard]] protocol::Json ask(std::string_view method,
                                   protocol::Json params = protocol::Json::object()) {
    const auto id = next_id_++;
    if (!send(protocol::to_line(protocol::make_request(id, method, std::move(params))) + '\n')) {
      return nullptr;
    }
    for (;;) {
      auto message = json();
      if (message.is_null() || (message.contains("id") && message["id"] == id)) {
        if (on_answer && message.contains("result")) on_answer(method, message["result"]);
        return message;
      }
    }
  }

  /// The next notification of this kind.
  [[nodiscard]] protocol::Json notification(std::string_view method) {
    for (;;) {
      auto message = json();
      if (message.is_null() || (message.contains("method") && message["method"] == method)) {
        return message;
      }
    }
  }

  /// True when the other end closes within the time; bytes that still come are discarded.
  [[nodiscard]] bool closed_by_peer(std::chrono::milliseconds limit = kPatience) {
    const auto until = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < until) {
      if (!receive(std::chrono::milliseconds(100)) && ended_) {
        return true;
      }
      while (framer_.next()) {
      }
    }
    return false;
  }

 private:
  bool receive(std::chrono::milliseconds limit) {
    pollfd ready{fd_, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(limit.count())) <= 0) {
      return false;
    }
    char buffer[16 * 1024];
    const auto size = recv(fd_, buffer, sizeof buffer, 0);
    ended_ = size <= 0;
    return size > 0 && static_cast<bool>(framer_.feed({buffer, static_cast<std::size_t>(size)}));
  }

  int fd_ = -1;
  bool connected_ = false;
  bool ended_ = false;
  int next_id_ = 1;
  protocol::LineFramer framer_{64 * protocol::kMaxLine};
};

}  // namespace mauve::test
