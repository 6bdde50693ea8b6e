// SPDX-License-Identifier: LGPL-3.0-or-later
/// port.connect and port.disconnect, for ports of components and of resources.
#include "base/duration.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/model.h"
#include "mauve/service.h"

namespace mauve::daemon {

namespace {

/// The edit of the element whose port it is, with the port's name in `port`.
Result<Edit> edit_of_port(const Running& running, const Json& params, std::string& port) {
  const auto address = text_or(params, "port");
  auto parts = split_port(address);
  if (!parts) {
    return parts.error();
  }
  const auto target = find_target(running, address);
  if (!target) {
    return target.error();
  }
  port = parts->second;
  return edit_of(parts->first);
}

/// A connected port gives its connection up for the new one only when that was asked for.
Status replace_connection(const Running& running, const Json& params, const std::string& port,
                          Edit& edit) {
  const auto address = text_or(params, "port");
  const auto target = find_target(running, address);
  if (!target) {
    return target.error();
  }
  const auto* present = connection(target->element, *target->port);
  if (present == nullptr) {
    return ok();
  }
  if (!flag(params, "replace")) {
    return refuse({Errc::duplicate, "port_connected"}, address,
                  "is connected to " + present->service().address() + " already",
                  "mauvectl connect --replace exchanges the connection at one instant");
  }
  edit.disconnect.push_back(port);
  return ok();
}

/// `max_age`, or zero when it is not given.
Result<Duration> limit_of(const Json& params) {
  if (!params.contains("max_age")) {
    return Duration{0};
  }
  const auto limit = parse_duration(text_or(params, "max_age"));
  if (!limit) {
    return refuse(reason_of(limit.error()), "max_age", limit.error().message, limit.error().hint);
  }
  if (*limit == Duration{0}) {
    return refuse({Errc::invalid_value, "max_age_invalid"}, "max_age", "must be over 0",
                  "leave it out for no limit");
  }
  return *limit;
}

}  // namespace

void connect(Running& running, const CallPtr& call, Ticket ticket) {
  std::string port;
  auto edit = edit_of_port(running, call->params, port);
  if (!edit) {
    return answer(running, *call, edit.error());
  }
  const auto max_age = limit_of(call->params);
  if (!max_age) {
    return answer(running, *call, max_age.error());
  }
  if (auto allowed = replace_connection(running, call->params, port, *edit); !allowed) {
    return answer(running, *call, allowed.error());
  }
  edit->connect.push_back({port, text_or(call->params, "service"), *max_age});
  apply(running, call, std::move(ticket), {{*std::move(edit)}});
}

void disconnect(Running& running, const CallPtr& call, Ticket ticket) {
  std::string port;
  auto edit = edit_of_port(running, call->params, port);
  if (!edit) {
    return answer(running, *call, edit.error());
  }
  edit->disconnect.push_back(port);
  apply(running, call, std::move(ticket), {{*std::move(edit)}});
}

}  // namespace mauve::daemon
