// SPDX-License-Identifier: LGPL-3.0-or-later
/// Between the socket and the commands: the users that may call each method, and the thread that
/// runs it.
#pragma once

#include "commands/command.h"

namespace mauve::daemon {

class CommandTable final : public server::Dispatcher {
 public:
  explicit CommandTable(Running& running) : running_(running) {}

  Json hello() override;
  void dispatch(const server::Caller& caller, const protocol::Method& method,
                protocol::Request request, server::Reply reply) override;
  void refused(const server::Caller& caller, const protocol::Method& method,
               protocol::Request request, const Fault& fault) override;
  void gone(std::uint64_t client) override;

 private:
  [[nodiscard]] CallPtr call_of(const server::Caller& caller, const protocol::Method& method,
                                protocol::Request request, server::Reply reply) const;
  /// The same reply, which counts the request as answered.
  [[nodiscard]] server::Reply counted(const protocol::Method& method, server::Reply reply) const;
  void run(const Command& command, const CallPtr& call);
  static bool has_gone(const Call& call);
  /// [control] A look for a client that has gone is dropped.
  void look(const Command& command, const Call& call);
  /// [control] The answer is written on [answer].
  void run_aside(const Command& command, const CallPtr& call);
  void run_as_change(const Command& command, const CallPtr& call);
  void run_in_factory(const Command& command, const CallPtr& call);

  Running& running_;
};

}  // namespace mauve::daemon
