// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>

#include "commands/actions.h"
#include "protocol/framing.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::Exit;
using protocol::wrong_use;
using RenderReceipt = std::string (*)(std::string_view, const Json&, Look);

/// The lines of the change and its receipt; of a dry run, the plan.
void print_change(Session& session, const Json& receipt, std::string_view done,
                  RenderReceipt render) {
  const bool dry_run = member(receipt, "dry_run") == true;
  session.print(receipt, dry_run ? render_plan("the change", receipt, session.look())
                                 : change_lines(receipt, session.look()) +
                                       render(done, receipt, session.look()));
}

int change(Session& session, std::string_view method, Json params, std::string_view done,
           RenderReceipt render = render_receipt) {
  const auto answer = session.call(method, std::move(params));
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& receipt = std::get<Json>(answer);
  print_change(session, receipt, done, render);
  return 0;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) join(text, name);
  return text;
}

/// "gain=0.3" to {"gain": 0.3}; a value that is not JSON is a text.
std::variant<Json, Fault> assignments(const std::vector<std::string>& given,
                                      const std::string& form) {
  Json values = Json::object();
  for (const auto& one : given) {
    const auto equals = one.find('=');
    if (equals == std::string::npos || equals == 0) {
      return wrong_use(
          "usage_not_an_assignment", "'" + one + "' is not " + form, {},
          form == "ADDRESS=VALUE" ? "example: control.core.gain=0.3" : "example: --set gain=0.3");
    }
    const std::string name = one.substr(0, equals);
    if (values.contains(name)) {
      const bool json = one.find_first_of("{[:", equals) != std::string::npos;
      return wrong_use("usage_set_twice", "'" + name + "' is set twice", {},
                       json ? "quote JSON for the shell: '" + name + "={...}'" : "");
    }
    const std::string text = one.substr(equals + 1);
    auto parsed = protocol::parse_json(text);
    values[name] = parsed ? std::move(*parsed) : Json(text);
  }
  return values;
}

int change_plugin(Session& session, std::string_view method, std::string_view verb) {
  const std::string plugin = session.arguments.one("PLUGIN");
  Json params = {{"plugin", plugin}};
  add_options(session, params);
  return change(session, method, std::move(params), std::string(verb) + " " + plugin,
                render_plugin);
}

int print_confirm_plan(Session& session, const Json& receipt) {
  std::string changes;
  for (const Json& one : list_in(receipt, "confirmed")) join(changes, changes_in_words(one));
  const std::string text =
      changes.empty() ? "no change is on probation" : "confirm would keep " + changes + " for good";
  session.print(receipt, text + "\nnothing was changed (generation " + word(receipt, "generation") +
                             " still running)\n");
  return 0;
}

}  // namespace

void add_options(const Session& session, Json& params) {
  constexpr std::pair<std::string_view, const char*> kOptions[] = {
      {"--state", "state"},
      {"--sync", "sync"},
      {"--probation", "probation"},
      {"--misses", "misses"},
      {"--confirm-within", "confirm_within"}};
  for (const auto& [option, name] : kOptions) {
    if (session.arguments.has(option)) params[name] = session.arguments.one(option);
  }
  if (session.arguments.has("--dry-run")) params["dry_run"] = true;
  if (session.arguments.has("--in-place")) params["in_place"] = true;
}

int run_set(Session& session) {
  auto values = assignments(session.arguments.all("ADDRESS=VALUE"), "ADDRESS=VALUE");
  if (const auto* fault = std::get_if<Fault>(&values)) return session.fail(*fault);
  std::vector<std::string> names;
  for (const auto& [name, value] : std::get<Json>(values).items()) names.push_back(name);
  Json params = {{"values", std::move(std::get<Json>(values))}};
  add_options(session, params);
  return change(session, "param.set", std::move(params), "set " + listed(names));
}

/// The components that a start or a stop is about, each once; none: all of them.
std::variant<std::vector<std::string>, Fault> names_or_all(const Session& session,
                                                           const std::string& verb) {
  std::vector<std::string> names;
  for (auto& name : session.arguments.all("COMPONENT")) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(std::move(name));
    }
  }
  const bool all = session.arguments.has("--all");
  if (all == names.empty()) return names;
  return wrong_use("usage_components_or_all",
                   all ? "either names of components, or --all" : "no component named", {},
                   "example: mauvectl " + verb + " control, or: mauvectl " + verb + " --all");
}

int run_start(Session& session) {
  const auto names = names_or_all(session, "start");
  if (const auto* fault = std::get_if<Fault>(&names)) return session.fail(*fault);
  const auto& components = std::get<std::vector<std::string>>(names);
  Json params = Json::object();
  if (components.empty()) params["all"] = true;
  if (!components.empty()) params["components"] = components;
  if (session.arguments.has("--reset")) params["reset"] = true;
  add_options(session, params);
  const std::string done = components.empty() ? "everything" : listed(components);
  return change(session, "component.start", std::move(params), "started " + done);
}

int run_stop(Session& session) {
  const auto names = names_or_all(session, "stop");
  if (const auto* fault = std::get_if<Fault>(&names)) return session.fail(*fault);
  const auto& components = std::get<std::vector<std::string>>(names);
  Json params = Json::object();
  if (components.empty()) params["all"] = true;
  if (!components.empty()) params["components"] = components;
  add_options(session, params);
  const std::string done = components.empty() ? "everything" : listed(components);
  return change(session, "component.stop", std::move(params), "stopped " + done);
}

int run_swap_core(Session& session) {
  const std::string component = session.arguments.one("COMPONENT");
  auto values = assignments(session.arguments.all("--set"), "NAME=VALUE");
  if (const auto* fault = std::get_if<Fault>(&values)) return session.fail(*fault);
  Json params = {{"component", component}, {"core", session.arguments.one("CORE")}};
  if (session.arguments.has("--set")) params["set"] = std::move(std::get<Json>(values));
  if (session.arguments.has("--budget")) params["budget"] = session.arguments.one("--budget");
  if (session.arguments.has("--defaults")) params["defaults"] = true;
  add_options(session, params);
  return change(session, "core.swap", std::move(params), "swapped " + component);
}

int run_connect(Session& session) {
  const std::string port = session.arguments.one("PORT");
  const std::string service = session.arguments.one("SERVICE");
  Json params = {{"port", port}, {"service", service}};
  if (session.arguments.has("--max-age")) params["max_age"] = session.arguments.one("--max-age");
  if (session.arguments.has("--replace")) params["replace"] = true;
  add_options(session, params);
  return change(session, "port.connect", std::move(params), "connected " + port + " to " + service);
}

int run_disconnect(Session& session) {
  const std::string port = session.arguments.one("PORT");
  Json params = {{"port", port}};
  add_options(session, params);
  return change(session, "port.disconnect", std::move(params), "disconnected " + port);
}

int run_change(Session& session) {
  auto params = file_params(session, "-f,--file");
  if (const auto* fault = std::get_if<Fault>(&params)) return session.fail(*fault);
  Json asked = std::get<Json>(std::move(params));
  add_options(session, asked);
  const auto answer = session.call("change.apply", std::move(asked));
  if (const auto* fault = std::get_if<Fault>(&answer)) {
    return fail_with_errors(session, *fault, session.arguments.one("-f,--file"));
  }
  const auto& receipt = std::get<Json>(answer);
  print_change(session, receipt, "changed", render_receipt);
  return 0;
}

int run_confirm(Session& session) {
  Json params = Json::object();
  add_options(session, params);
  const auto answer = session.call("change.confirm", std::move(params));
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& receipt = std::get<Json>(answer);
  if (member(receipt, "dry_run") == true) return print_confirm_plan(session, receipt);
  if (member(receipt, "changed") == false) {
    session.print(receipt, "generation " + word(receipt, "generation") +
                               " is kept already: no change is on probation\n");
    return 0;
  }
  std::string changes;
  for (const Json& one : list_in(receipt, "confirmed")) join(changes, changes_in_words(one));
  if (changes.empty()) changes = "the generation that runs";  // new code without a probation
  session.print(receipt, render_receipt("confirmed " + changes, receipt, session.look()));
  return 0;
}

int run_undo(Session& session) {
  Json params = Json::object();
  if (const std::string wanted = session.arguments.one("GENERATION"); !wanted.empty()) {
    const auto generation = count_of(wanted);
    if (!generation || *generation == 0) {
      return session.fail(wrong_use("usage_not_a_generation",
                                    "'" + wanted + "' is not a generation", {},
                                    "mauvectl status shows the changes on probation"));
    }
    params["generation"] = *generation;
  }
  add_options(session, params);
  const auto answer = session.call("change.undo", std::move(params));
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& receipt = std::get<Json>(answer);
  const std::string lines = change_lines(receipt, session.look());
  const std::string changes = changes_in_words(member(receipt, "undone"));
  if (member(receipt, "dry_run") == true) {
    session.print(receipt, lines + "undo would take back " + changes + "\n" +
                               note_lines(receipt, session.look()) +
                               "nothing was changed (generation " + word(receipt, "generation") +
                               " still running)\n");
    return 0;
  }
  session.print(receipt, lines + render_receipt("took back " + changes, receipt, session.look()));
  return 0;
}

int run_quarantine(Session& session) {
  const std::string action = session.arguments.one("ACTION");
  const std::string core = session.arguments.one("CORE");
  if (action == "release" && !core.empty()) {
    return change(session, "quarantine.release", {{"core", core}}, "released " + core);
  }
  if (!action.empty()) {
    return session.fail(wrong_use("usage_missing_argument", "release takes a core", {},
                                  "example: mauvectl quarantine release guidance/widest_gap"));
  }
  const auto answer = session.call("quarantine.list", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& list = std::get<Json>(answer);
  session.print(list, render_quarantine(list, session.look()));
  return static_cast<int>(Exit::ok);
}

int run_rollback(Session& session) {
  const std::string wanted = session.arguments.one("GENERATION");
  const auto generation = count_of(wanted);
  if (!generation) {
    return session.fail(wrong_use("usage_not_a_generation", "'" + wanted + "' is not a generation",
                                  {}, "mauvectl history lists them"));
  }
  Json params = {{"generation", *generation}};
  add_options(session, params);
  const auto answer = session.call("config.rollback", std::move(params));
  if (const auto* fault = std::get_if<Fault>(&answer)) {
    return fail_with_errors(session, *fault, "generation " + wanted);
  }
  print_change(session, std::get<Json>(answer), "rolled back to generation " + wanted,
               render_receipt);
  return 0;
}

int run_lock(Session& session) {
  const std::string lock = session.arguments.one("LOCK");
  return change(session, "lock.set", {{"lock", lock}},
                lock == "none" ? "unlocked" : "locked " + lock);
}

int run_load(Session& session) { return change_plugin(session, "plugin.load", "loaded"); }
int run_unload(Session& session) { return change_plugin(session, "plugin.unload", "unloaded"); }
int run_reload(Session& session) { return change_plugin(session, "plugin.reload", "reloaded"); }

}  // namespace mauve::ctl
