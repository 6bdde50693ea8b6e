// SPDX-License-Identifier: LGPL-3.0-or-later
/// port.connect and port.disconnect, for ports of components and of resources.
#include "base/duration.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/model.h"
#include "mauve/host/architecture.h"
#include "mauve/service.h"
#include "model/port/connection.h"

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

/// Adds the connection, if it is not there already. A connected port gives its connection up for
/// the new one only when that was asked for.
Status add_connection(const Running& running, const Json& params, const std::string& port,
                      Duration max_age, Edit& edit) {
  const auto address = text_or(params, "port");
  const auto name = text_or(params, "service");
  const auto target = find_target(running, address);
  if (!target) {
    return target.error();
  }
  const auto* present = connection(target->element, *target->port);
  if (present != nullptr) {
    const auto service = running.architecture.find_service(name);
    const bool same_age = !params.contains("max_age") || present->max_age() == max_age;
    if (service && &present->service() == *service && same_age) {
      return ok();
    }
    if (service) {
      if (auto fits = check_connection(*target->port, nullptr, **service, max_age); !fits) {
        return fits;
      }
    }
    if (!flag(params, "replace")) {
      return refuse({Errc::duplicate, "port_connected"}, address,
                    "is connected to " + present->service().address() + " already",
                    "mauvectl connect --replace exchanges the connection at one instant");
    }
    edit.disconnect.push_back(port);
  }
  edit.connect.push_back({port, name, max_age});
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
  if (auto added = add_connection(running, call->params, port, *max_age, *edit); !added) {
    return answer(running, *call, added.error());
  }
  if (edit->connect.empty()) {
    return answer(running, *call, to_json(Receipt{running.generation, {}, {}, 0, {}}));
  }
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
