// SPDX-License-Identifier: LGPL-3.0-or-later
/// A server that misbehaves as a test says, on a socket in a folder of its own.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <functional>
#include <string>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/write.hpp>

#include "protocol/message.h"
#include "support/temp_dir.h"

namespace mauve::ctl {

inline const std::string kHello =
    R"({"jsonrpc":"2.0","method":"hello","params":{"server":"mauved 9","protocol":[1],)"
    R"("generation":41}})"
    "\n";

/// The server's side of one connection.
class Peer {
 public:
  explicit Peer(boost::asio::local::stream_protocol::socket& socket) : socket_(socket) {}

  void say(const std::string& text) {
    boost::system::error_code ignored;
    boost::asio::write(socket_, boost::asio::buffer(text), ignored);
  }

  /// The next request; its params are null when the client went away.
  protocol::Request hear() {
    boost::system::error_code error;
    const auto size = boost::asio::read_until(socket_, buffer_, '\n', error);
    if (error) return {nullptr, "", nullptr};
    const auto* begin = static_cast<const char*>(buffer_.data().data());
    auto parsed = protocol::parse_request(std::string(begin, size - 1));
    buffer_.consume(size);
    if (auto* request = std::get_if<protocol::Request>(&parsed)) return std::move(*request);
    return {nullptr, "", nullptr};
  }

  void answer(const protocol::Request& request, protocol::Json result) {
    say(protocol::to_line(protocol::make_response(request.id, std::move(result))) + "\n");
  }

  /// Until the client goes away.
  void wait_for_the_end() {
    while (!hear().id.is_null()) {
    }
  }

 private:
  boost::asio::local::stream_protocol::socket& socket_;
  boost::asio::streambuf buffer_;
};

/// Serves `connections` clients one after another with the script, then listens no more.
class FakeServer {
 public:
  using Script = std::function<void(Peer&)>;

  explicit FakeServer(Script script, int connections = 1, const std::string& name = "s")
      : path_(folder_ / name),
        acceptor_(io_, boost::asio::local::stream_protocol::endpoint(path_)),
        thread_([this, script = std::move(script), connections] { serve(script, connections); }) {
    // A mauvectl that a test starts would listen too.
    fcntl(acceptor_.native_handle(), F_SETFD, FD_CLOEXEC);
  }

  ~FakeServer() { thread_.join(); }

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void serve(const Script& script, int connections) {
    for (int i = 0; i < connections; ++i) {
      boost::asio::local::stream_protocol::socket socket(io_);
      acceptor_.accept(socket);
      if (i + 1 == connections) acceptor_.close();
      Peer peer(socket);
      script(peer);
    }
  }

  test::TempDir folder_;
  std::string path_;
  boost::asio::io_context io_;
  boost::asio::local::stream_protocol::acceptor acceptor_;
  std::thread thread_;
};

}  // namespace mauve::ctl
