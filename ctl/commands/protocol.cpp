// SPDX-License-Identifier: LGPL-3.0-or-later
/// The protocol itself, and commands that only print the answer of a method.
#include "commands/actions.h"
#include "protocol/methods.h"
#include "protocol/openrpc.h"

namespace mauve::ctl {

int run_protocol(Session& session) {
  const std::string name = session.arguments.one("METHOD");
  if (name.empty()) {
    session.print(protocol::openrpc_document(protocol::methods()), render_methods(session.look()));
    return 0;
  }
  const protocol::Method* method = protocol::find_method(name);
  if (method == nullptr) return session.fail(protocol::unknown_method(name));
  session.print(protocol::openrpc_document({method, 1}), render_method(*method, session.look()));
  return 0;
}

int run_answer(Session& session) {
  const protocol::Method* method = protocol::find_method(session.command.method);
  const auto answer = session.call(session.command.method, Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  session.print(result, render_answer(*method, result, session.look()));
  return 0;
}

}  // namespace mauve::ctl
