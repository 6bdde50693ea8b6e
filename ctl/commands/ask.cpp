// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <iterator>
#include <string>

#include "base/name.h"
#include "commands/actions.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::wrong_use;
using RenderAnswer = std::string (*)(const Json&, Look);

int ask(Session& session, std::string_view method, const Json& params, RenderAnswer render) {
  const auto answer = session.call(method, params);
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  session.print(result, render(result, session.look()));
  return 0;
}

/// A client with options that the daemon does not know must not send them.
Json without_empty(Json params) {
  for (auto it = params.begin(); it != params.end();) {
    it = *it == "" ? params.erase(it) : std::next(it);
  }
  return params;
}

std::string listed(const Json& object, const char* key) {
  const std::string text = word(object, key);
  return text.starts_with('[') ? text.substr(1, text.size() - 2) : text;
}

std::string nearest_category(const std::string& wanted) {
  std::vector<std::string> names;
  for (const Category& category : categories()) names.emplace_back(category.name);
  return nearest_name(wanted, names);
}

}  // namespace

int run_status(Session& session) {
  return ask(session, "status.get", Json::object(), render_status);
}

int run_list(Session& session) {
  const std::string kind =
      session.arguments.has("KIND") ? session.arguments.one("KIND") : "components";
  const auto all = categories();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Category& one) {
    return one.name == kind || one.name == kind + "s";
  });
  if (found != all.end()) {
    const bool plugins = found->name == "plugins";
    return ask(session, found->method, Json::object(), plugins ? render_plugins : render_list);
  }
  const std::string nearest = nearest_category(kind);
  return session.fail(wrong_use("usage_unknown_word", "there is no list of '" + kind + "'", {},
                                nearest.empty()
                                    ? "components, resources, services, cores, fsms, types, ports, "
                                      "plugins, clients"
                                    : "did you mean '" + nearest + "'?"));
}

int run_show(Session& session) {
  return ask(session, "object.get", {{"address", session.arguments.one("ADDRESS")}}, render_object);
}

int run_get(Session& session) {
  int exit = 0;
  for (const auto& address : session.arguments.all("ADDRESS")) {
    const int one = ask(session, "param.get", {{"address", address}}, render_value);
    if (exit == 0) exit = one;
    if (one == static_cast<int>(protocol::Exit::unreachable)) break;
  }
  return exit;
}

int run_plugins(Session& session) {
  const bool for_one = session.arguments.has("--for");
  return ask(session, "plugin.list", without_empty({{"for", session.arguments.one("--for")}}),
             for_one ? render_plugins_for : render_plugins);
}

int run_analyze(Session& session) {
  return ask(session, "system.analyze", Json::object(), render_analysis);
}

int run_rules(Session& session) {
  const bool one = session.arguments.has("RULE");
  return ask(session, "rules.list", without_empty({{"rule", session.arguments.one("RULE")}}),
             one ? render_rule : render_rules);
}

int run_why(Session& session) {
  return ask(session, "component.why", {{"component", session.arguments.one("COMPONENT")}},
             render_why);
}

int run_export(Session& session) {
  const auto answer = session.call("config.get", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  const Json architecture = result.is_object() ? result.value("architecture", Json()) : Json();
  session.screen.out << (session.screen.json ? architecture_line(architecture)
                                             : render_architecture(architecture));
  session.screen.out.flush();
  return 0;
}

int run_ping(Session& session) {
  const auto begin = std::chrono::steady_clock::now();
  const auto answer = session.call("ping", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
  session.print(std::get<Json>(answer),
                "mauved answers in " + nanoseconds_in_words(took.count()) + "\n");
  return 0;
}

int run_version(Session& session) {
  const auto answer = session.call("version", Json::object());
  const std::string client = std::string("mauvectl ") + MAUVE_VERSION;
  if (const auto* fault = std::get_if<Fault>(&answer)) {
    if (!session.screen.json) session.screen.out << client << "\n";
    return session.fail(*fault);
  }
  Json result = std::get<Json>(answer);
  const std::string text = client + "\nmauved " + word(result, "version") + ", plugin ABI " +
                           word(result, "abi") + ", protocol " + listed(result, "protocol") + "\n";
  result["client"] = client;
  session.print(result, text);
  return 0;
}

int run_check(Session& session) {
  const std::string file = session.arguments.one("FILE");
  auto params = file_params(session);
  if (const auto* fault = std::get_if<Fault>(&params)) return session.fail(*fault);
  const auto answer = session.call("config.check", std::get<Json>(std::move(params)));
  if (const auto* fault = std::get_if<Fault>(&answer)) {
    Fault said = *fault;
    const std::string alone = "without the daemon: mauved --check " + file +
                              "; --plugin-dir DIR names a folder of plugins";
    if (said.exit == static_cast<int>(protocol::Exit::unreachable)) said.hint = alone;
    return session.fail(said);
  }
  const auto& result = std::get<Json>(answer);
  session.print(result, render_errors(file, result, session.look()));
  return word(result, "errors") == "[]" ? 0 : 1;
}

}  // namespace mauve::ctl
