// SPDX-License-Identifier: LGPL-3.0-or-later
/// A daemon without a runtime behind the socket, and the server in front of it.
#pragma once

#include <unistd.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "log/log.h"
#include "server/server.h"
#include "support/raw_client.h"
#include "support/temp_dir.h"

namespace mauve::test {

/// ping answers at once; watch.subscribe opens a subscription; every other method is kept until the
/// test answers it.
class FakeDispatcher final : public server::Dispatcher {
 public:
  protocol::Json hello() override { return {{"server", "fake"}, {"generation", 1}}; }

  void dispatch(const server::Caller& caller, const protocol::Method& method,
                protocol::Request request, server::Reply reply) override {
    const std::lock_guard lock(mutex_);
    ++served_;
    if (method.name == "ping") {
      return reply(protocol::Json{{"pong", true}});
    }
    if (method.name == "watch.subscribe") {
      const auto sub = caller.outbox->open();
      outboxes_.push_back(caller.outbox);
      return reply(protocol::Json{{"sub", sub.value_or(0)}});
    }
    if (method.name == "config.get") {
      return reply(protocol::Json{{"architecture", std::string(big_answer, 'x')}});
    }
    requests_.push_back(std::move(request));
    kept_.push_back(std::move(reply));
  }

  void refused(const server::Caller& /*caller*/, const protocol::Method& method,
               protocol::Request /*request*/, const protocol::Fault& fault) override {
    const std::lock_guard lock(mutex_);
    refused_.push_back(std::string(method.name) + ": " + fault.name);
  }

  void gone(std::uint64_t client) override {
    const std::lock_guard lock(mutex_);
    gone_.push_back(client);
  }

  /// Answers everything that was kept.
  void answer_all() {
    std::vector<server::Reply> kept;
    {
      const std::lock_guard lock(mutex_);
      kept.swap(kept_);
    }
    for (auto& reply : kept) {
      reply(protocol::Json{{"late", true}});
    }
  }

  std::size_t kept() const {
    const std::lock_guard lock(mutex_);
    return kept_.size();
  }
  std::size_t served() const { return served_; }
  /// The requests that never reached dispatch(): "param.set: limit".
  std::vector<std::string> refused_ones() const {
    const std::lock_guard lock(mutex_);
    return refused_;
  }
  std::vector<std::uint64_t> gone_clients() const {
    const std::lock_guard lock(mutex_);
    return gone_;
  }
  std::shared_ptr<server::Outbox> outbox(std::size_t index) const {
    const std::lock_guard lock(mutex_);
    return outboxes_.at(index);
  }

  std::size_t big_answer = 10;

 private:
  mutable std::mutex mutex_;
  std::vector<protocol::Request> requests_;
  std::vector<server::Reply> kept_;
  std::vector<std::uint64_t> gone_;
  std::vector<std::string> refused_;
  std::vector<std::shared_ptr<server::Outbox>> outboxes_;
  std::atomic<std::size_t> served_{0};
};

/// A server on a socket of its own, for as long as the test lasts.
struct ServedSocket {
  explicit ServedSocket(server::Limits limits = {}, server::RoleRules rules = {},
                        std::function<server::RoleRules()> look_again = {},
                        const std::string& inner = {})
      : folder(dir / inner), log(logging::Level::debug) {
    log.start();
    rules.own_uid = geteuid();
    server = std::make_unique<server::Server>(
        server::ServerOptions{limits, rules, std::move(look_again)}, dispatcher, log);
    auto endpoint = server::Endpoint::open(path());
    opened = endpoint ? server->open(std::move(*endpoint)) : Status(endpoint.error());
    server->start();
  }
  ~ServedSocket() {
    server.reset();
    log.stop();
  }

  [[nodiscard]] std::filesystem::path path() const { return folder / "mauved.sock"; }
  [[nodiscard]] std::filesystem::path path_of_stops() const { return folder / "mauved.sock.stop"; }
  /// A client that has read its greeting.
  [[nodiscard]] RawClient client() const {
    RawClient out(path());
    static_cast<void>(out.line());
    return out;
  }
  /// Why clients went, as the log reports it.
  [[nodiscard]] std::string log_text() {
    log.flush();
    std::string out;
    for (const auto& record : log.history().tail(1000, {})) {
      out += record.text + "\n";
    }
    return out;
  }

  TempDir dir;
  std::filesystem::path folder;  ///< of the socket; made by the server
  logging::Log log;
  FakeDispatcher dispatcher;
  std::unique_ptr<server::Server> server;
  Status opened;
};

}  // namespace mauve::test
