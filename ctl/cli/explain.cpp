// SPDX-License-Identifier: LGPL-3.0-or-later
/// explain: the meaning of an event of the log, of a reason to refuse a command, or of a failure,
/// and the remedy, without a daemon. It also names the plugin that brings a name.
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

/// The state of the running system after a refusal: the third column of refusals.def.
enum class Aftermath { unchanged, partly, unknown, start, unsent, apart };

constexpr std::string_view state_after(Aftermath aftermath) {
  switch (aftermath) {
    case Aftermath::unchanged:
      return "Nothing has changed: all components run on as before.";
    case Aftermath::partly:
      return "Only a part of the change happened. `mauvectl status` shows the components.";
    case Aftermath::unknown:
      return "The change may still take effect: `mauvectl history` shows whether it did.";
    case Aftermath::start:
      return "mauved does not start, and no component has moved.";
    case Aftermath::unsent:
      return "Nothing was sent to mauved: the running system is as it was.";
    case Aftermath::apart:
      return "mauved and its components are not concerned.";
  }
  return {};
}

struct Message {
  std::string_view kind;
  std::string_view name;
  std::string_view level;  ///< of an event
  std::string_view text;
  std::string_view advice;
  std::string_view refusal = {};  ///< the kind of a refusal, such as conflict
  std::string_view system = {};   ///< the state of the running system after a refusal
};

constexpr Message kMessages[] = {
#define MAUVE_EVENT(number, name, level, text, advice) {"event", #name, #level, text, advice},
#include "log/events.def"
#undef MAUVE_EVENT
#define MAUVE_ERROR(name, meaning, advice) {"refusal", #name, "", meaning, advice},
#define MAUVE_FAILURE(name, meaning, advice) {"failure", #name, "", meaning, advice},
#define MAUVE_VALUE_STATUS(name, meaning, advice) {"status", #name, "", meaning, advice},
#include "protocol/errors.def"
#undef MAUVE_VALUE_STATUS
#undef MAUVE_FAILURE
#undef MAUVE_ERROR
#define MAUVE_REFUSAL(name, kind, state, meaning, advice) \
  {"refusal", #name, "", meaning, advice, #kind, state_after(Aftermath::state)},
#include "protocol/refusals.def"
#undef MAUVE_REFUSAL
};

Json json_of(const Message& message) {
  Json json = {{"kind", message.kind},
               {"name", message.name},
               {"text", message.text},
               {"advice", message.advice}};
  if (!message.level.empty()) json["level"] = message.level;
  if (!message.refusal.empty()) json["refusal"] = message.refusal;
  if (!message.system.empty()) json["system"] = message.system;
  return json;
}

/// "event, warn", "refusal, conflict", "refusal".
std::string kind_of(const Message& message) {
  const std::string_view more = message.level.empty() ? message.refusal : message.level;
  return std::string(message.kind) + (more.empty() ? "" : ", " + std::string(more));
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

int list_messages(Session& session) {
  Json items = Json::array();
  std::string text;
  for (const Message& message : kMessages) {
    items.push_back(json_of(message));
    const bool event = message.kind == "event";
    text += bold(message.name, session) + " (" + kind_of(message) + ")\n" +
            wrapped("    " + first_sentence(event ? message.advice : message.text),
                    session.screen.width, 4) +
            "\n";
  }
  session.print({{"items", std::move(items)}}, text);
  return 0;
}

int explain_message(Session& session, const Message& message) {
  const bool event = message.kind == "event";
  // A text that is one value only stands in the log as it is.
  const bool shown = message.text != "{text}";
  const std::string system = message.system.empty() ? "" : part("system", message.system, session);
  session.print(json_of(message),
                bold(message.name, session) + "\n" + part("kind", kind_of(message), session) +
                    (shown ? part(event ? "text" : "meaning", message.text, session) : "") +
                    system + part(event ? "meaning" : "advice", message.advice, session));
  return 0;
}

/// The facts of plugin.list about each plugin, and how one of these is called.
constexpr std::pair<const char*, std::string_view> kBrought[] = {{"cores", "a core"},
                                                                 {"fsms", "a state machine"},
                                                                 {"components", "a component"},
                                                                 {"types", "a type of data"},
                                                                 {"resources", "a resource"}};

/// The kind of the name in the loaded plugins; null when no plugin brings it. All names go to
/// `known`.
Json brought_as(const Json& plugins, const std::string& name, std::vector<std::string>& known) {
  Json found;
  for (const Json& plugin : list_in(plugins, "items")) {
    known.push_back(word(plugin, "name"));
    if (known.back() == name) {
      found = {{"name", name},
               {"is", "a plugin"},
               {"plugin", name},
               {"version", word(plugin, "version")},
               {"file", word(plugin, "file")}};
      for (const auto& [group, one] : kBrought) found[group] = list_in(plugin, group);
    }
    for (const auto& [group, what] : kBrought) {
      for (const Json& one : list_in(plugin, group)) {
        known.push_back(compact(one));
        if (known.back() != name) continue;
        const std::string before = word(found, "is");  // a component and its state machine
        found = {{"name", name},
                 {"is", before.empty() ? std::string(what) : before + " and " + std::string(what)},
                 {"plugin", word(plugin, "name")},
                 {"version", word(plugin, "version")},
                 {"file", word(plugin, "file")}};
      }
    }
  }
  return found;
}

/// "a core of plugin guidance 1.0".
std::string is_of(const Json& found) {
  const bool itself = word(found, "plugin") == word(found, "name");
  return word(found, "is") + (itself ? ", version " : " of plugin " + word(found, "plugin") + " ") +
         word(found, "version");
}

/// The names that a plugin brings, as the architecture file takes them, a line for each kind.
std::string names_of(const Json& found, const Session& session) {
  std::string text;
  for (const auto& [group, one] : kBrought) {
    std::string names;
    for (const Json& name : list_in(found, group)) join(names, compact(name));
    if (!names.empty()) text += part(group, names, session);
  }
  return text;
}

int explain_brought(Session& session, const std::string& name) {
  std::vector<std::string> known = message_names();
  const auto answer = session.call("plugin.list", Json::object());
  const auto* plugins = std::get_if<Json>(&answer);
  if (plugins != nullptr) {
    if (const Json found = brought_as(*plugins, name, known); !found.is_null()) {
      session.print(found, bold(name, session) + "\n" + part("is", is_of(found), session) +
                               part("file", word(found, "file"), session) +
                               names_of(found, session));
      return 0;
    }
  }
  const std::string list = plugins != nullptr
                               ? "mauvectl explain lists all messages, mauvectl plugins what "
                                 "plugins bring"
                               : "start mauved, or name it with --socket; mauvectl explain lists "
                                 "all messages";
  const std::string near = did_you_mean(name, known, "'");
  return session.fail(fault_of(refuse(
      {Errc::unknown_name, "unknown_message"}, name,
      plugins != nullptr ? "no message, no plugin and nothing that a plugin brings has this name"
                         : "no message has this name, and plugins cannot be looked up: no mauved "
                           "answers at " +
                               session.globals.socket,
      near.empty() ? list : near + " " + list)));
}

}  // namespace

std::vector<std::string> message_names() {
  std::vector<std::string> names;
  for (const Message& message : kMessages) names.emplace_back(message.name);
  return names;
}

int run_explain(Session& session) {
  const Arguments& given = session.arguments;
  const std::string name = given.has("NAME") ? given.one("NAME") : given.one("COMPONENT");
  if (name.empty()) return list_messages(session);
  const auto* found = std::ranges::find(kMessages, name, &Message::name);
  return found == std::end(kMessages) ? explain_brought(session, name)
                                      : explain_message(session, *found);
}

}  // namespace mauve::ctl
