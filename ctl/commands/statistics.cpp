// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "commands/actions.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

int reset(Session& session, const std::string& component) {
  Json params = Json::object();
  if (!component.empty()) params["component"] = component;
  const auto answer = session.call("stats.reset", std::move(params));
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  const std::string whose =
      component.empty() ? counted(list_in(result, "components").size(), "component") : component;
  session.print(result, "counting anew what the jobs of " + whose + " take\n");
  return 0;
}

}  // namespace

int run_stats(Session& session) {
  const std::string address = session.arguments.one("ADDRESS");
  const std::string component = session.arguments.one("COMPONENT");
  if (address == "reset") return reset(session, component);
  if (!component.empty()) {
    return session.fail(protocol::wrong_use("usage_too_many_arguments", "one address at a time",
                                            component,
                                            "mauvectl stats reset " + component + " counts anew"));
  }
  const Json params = address.empty() ? Json::object() : Json{{"address", address}};
  const auto answer = session.call("stats.get", params);
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  session.print(result, render_statistics(result, session.look()));
  return 0;
}

int run_metrics(Session& session) {
  const auto answer = session.call("metrics.get", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  const auto text = result.find("text");
  const bool is_text = text != result.end() && text->is_string();
  session.print(result, is_text ? text->get<std::string>() : std::string());
  return 0;
}

}  // namespace mauve::ctl
