// SPDX-License-Identifier: LGPL-3.0-or-later
/// explain: what an event of the log means and what to do about it, for which no daemon is needed;
/// and what a name is that a loaded plugin brings.
#include <algorithm>
#include <string>
#include <vector>

#include "base/name.h"
#include "commands/actions.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::fault_of;

struct EventRow {
  std::string_view name;
  std::string_view level;
  std::string_view text;
  std::string_view advice;
};

constexpr EventRow kEvents[] = {
#define MAUVE_EVENT(number, name, level, text, advice) {#name, #level, text, advice},
#include "log/events.def"
#undef MAUVE_EVENT
};

Json json_of(const EventRow& event) {
  return {{"event", event.name},
          {"level", event.level},
          {"text", event.text},
          {"advice", event.advice}};
}

std::string first_sentence(std::string_view text) {
  const auto end = text.find(". ");
  return std::string(text.substr(0, end == std::string_view::npos ? end : end + 1));
}

std::string bold(std::string_view name, const Session& session) {
  return painted(std::string(name), Paint::bold, session.screen.colour_out);
}

/// "  level  : warn", as refusals are printed.
std::string part(std::string title, std::string_view content, const Session& session) {
  title.resize(std::max<std::size_t>(title.size(), 7), ' ');
  return wrapped("  " + title + ": " + harmless(content), session.screen.width, 11) + "\n";
}

int list_events(Session& session) {
  Json items = Json::array();
  std::string text;
  for (const EventRow& event : kEvents) {
    items.push_back(json_of(event));
    text += bold(event.name, session) + " (" + std::string(event.level) + ")\n" +
            wrapped("    " + first_sentence(event.advice), session.screen.width, 4) + "\n";
  }
  session.print({{"items", std::move(items)}}, text);
  return 0;
}

int explain_event(Session& session, const EventRow& event) {
  session.print(json_of(event),
                bold(event.name, session) + "\n" + part("level", event.level, session) +
                    part("text", event.text, session) + part("meaning", event.advice, session));
  return 0;
}

/// The facts of plugin.list about each plugin, and how one of these is called.
constexpr std::pair<const char*, std::string_view> kBrought[] = {{"cores", "a core"},
                                                                 {"fsms", "a state machine"},
                                                                 {"components", "a component"},
                                                                 {"types", "a type of data"},
                                                                 {"resources", "a resource"}};

/// What the name is in the loaded plugins; null when none brings it. All names go to `known`.
Json brought_as(const Json& plugins, const std::string& name, std::vector<std::string>& known) {
  Json found;
  for (const Json& plugin : list_in(plugins, "items")) {
    for (const auto& [group, what] : kBrought) {
      for (const Json& one : list_in(plugin, group)) {
        known.push_back(compact(one));
        if (known.back() != name) continue;
        found = {{"name", name},
                 {"is", what},
                 {"plugin", word(plugin, "name")},
                 {"version", word(plugin, "version")},
                 {"file", word(plugin, "file")}};
      }
    }
  }
  return found;
}

int explain_brought(Session& session, const std::string& name) {
  std::vector<std::string> known = event_names();
  std::string list = "mauvectl explain lists all events";
  const auto answer = session.call("plugin.list", Json::object());
  if (const auto* plugins = std::get_if<Json>(&answer)) {
    if (const Json found = brought_as(*plugins, name, known); !found.is_null()) {
      const std::string plugin = word(found, "plugin") + " " + word(found, "version");
      session.print(found, bold(name, session) + "\n" +
                               part("is", word(found, "is") + " of plugin " + plugin, session) +
                               part("file", word(found, "file"), session));
      return 0;
    }
    list += ", mauvectl plugins what plugins bring";
  } else {
    list += "; what plugins bring only a running mauved knows";
  }
  const std::string near = did_you_mean(name, known, "'");
  return session.fail(
      fault_of(refuse(Errc::unknown_name, name, "no event and nothing of a plugin has this name",
                      near.empty() ? list : near + " " + list)));
}

}  // namespace

std::vector<std::string> event_names() {
  std::vector<std::string> names;
  for (const EventRow& event : kEvents) names.emplace_back(event.name);
  return names;
}

int run_explain(Session& session) {
  const Arguments& given = session.arguments;
  const std::string name = given.has("NAME") ? given.one("NAME") : given.one("COMPONENT");
  if (name.empty()) return list_events(session);
  const auto* found = std::find_if(std::begin(kEvents), std::end(kEvents),
                                   [&](const EventRow& event) { return event.name == name; });
  return found == std::end(kEvents) ? explain_brought(session, name)
                                    : explain_event(session, *found);
}

}  // namespace mauve::ctl
