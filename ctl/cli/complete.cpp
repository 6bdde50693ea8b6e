// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/complete.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "cli/client.h"
#include "cli/options.h"
#include "commands/actions.h"
#include "protocol/methods.h"
#include "protocol/socket_path.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using Words = std::vector<std::string>;

/// The command line as far as it is understood: options are left out of `positionals`.
struct Typed {
  const Command* command = nullptr;
  Words positionals;
  const Argument* waiting = nullptr;  ///< the option that the last word is the value of
  std::string socket;
  std::chrono::milliseconds within{};  ///< for an answer of the daemon
};

/// "-n" and "--lines" both mean "-n,--lines".
bool is_called(const Argument& argument, std::string_view word) {
  std::string_view rest = argument.name;
  while (!rest.empty()) {
    const auto comma = rest.find(',');
    if (rest.substr(0, comma) == word) return true;
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
  }
  return false;
}

const Argument* option_called(const Command* command, std::string_view word) {
  const auto find_in = [&](std::span<const Argument> arguments) -> const Argument* {
    const auto found = std::find_if(arguments.begin(), arguments.end(), [&](const Argument& one) {
      return one.is_option() && is_called(one, word);
    });
    return found == arguments.end() ? nullptr : &*found;
  };
  const Argument* own = command == nullptr ? nullptr : find_in(command->arguments);
  return own != nullptr ? own : find_in(global_options());
}

Typed understand(const Words& words) {
  Typed typed;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (typed.waiting != nullptr) {
      if (typed.waiting->name == "--socket") typed.socket = words[i];
      typed.waiting = nullptr;
    } else if (words[i].starts_with('-')) {
      const auto equals = words[i].find('=');
      const Argument* option = option_called(typed.command, words[i].substr(0, equals));
      if (option == nullptr || option->flag) continue;
      if (equals == std::string::npos) {
        typed.waiting = option;
      } else if (option->name == "--socket") {
        typed.socket = words[i].substr(equals + 1);
      }
    } else if (typed.command == nullptr) {
      typed.command = find_command(words[i]);
    } else {
      typed.positionals.push_back(words[i]);
    }
  }
  return typed;
}

using Candidates = std::vector<Candidate>;

Candidates options_of(const Command* command) {
  Candidates names{{"--help", "Print help"}};
  const auto add = [&](const Argument& one) {
    if (!one.is_option()) return;
    names.push_back({std::string(one.name.substr(one.name.rfind(',') + 1)), std::string(one.text)});
  };
  if (command != nullptr) {
    std::for_each(command->arguments.begin(), command->arguments.end(), add);
  }
  std::for_each(global_options().begin(), global_options().end(), add);
  return names;
}

const Argument* next_positional(const Typed& typed) {
  std::size_t index = typed.positionals.size();
  for (const Argument& one : typed.command->arguments) {
    if (one.is_option()) continue;
    if (one.many || index == 0) return &one;
    --index;
  }
  return nullptr;
}

/// Live names; silent when there is no daemon.
class Live {
 public:
  explicit Live(const Typed& typed)
      : client_(typed.socket.empty() ? protocol::default_socket_path() : typed.socket,
                typed.within),
        within_(typed.within),
        connected_(!client_.connect()) {}

  Words names(std::string_view method, const Json& params = Json::object()) {
    return column(method, "name", params);
  }

  /// This member of each item.
  Words column(std::string_view method, std::string_view key, const Json& params = Json::object()) {
    Words result;
    const Json found = items(ask(method, params), "items");
    for (const Json& item : found) {
      if (std::string name = word(item, key); !name.empty()) result.push_back(std::move(name));
    }
    return result;
  }

  /// Elements; below an element its members, of one kind only when a group is named.
  Words addresses(const std::string& begun, std::string_view only = {}) {
    const auto dot = begun.find('.');
    if (dot != std::string::npos) return inside(begun.substr(0, dot), only);
    Words result = names("component.list");
    for (auto& name : names("resource.list")) result.push_back(std::move(name));
    return result;
  }

  /// That fit the component; all when there is none.
  Words cores(const std::string& component) {
    return names("core.list", component.empty() ? Json::object() : Json{{"for", component}});
  }

  /// All services; of a port that exists, those that it can be connected to.
  Words services(const std::string& port) {
    const Json graph = ask("architecture.graph", Json::object());
    const Json wanted = port_in(graph, port);
    Words result;
    for (const Json& resource : list_in(graph, "resources")) {
      for (const Json& service : list_in(resource, "services")) {
        const bool fits = wanted.is_null() || (member(service, "kind") == member(wanted, "kind") &&
                                               member(service, "type") == member(wanted, "type"));
        if (fits) result.push_back(word(resource, "name") + "." + word(service, "name"));
      }
    }
    return result;
  }

  /// Files in the directories of the daemon that are not loaded.
  Words available_plugins() {
    const Words loaded = names("plugin.list");
    Words result;
    const Json doctor = ask("daemon.doctor", Json::object());
    for (const Json& folder : list_in(doctor, "plugin_dirs")) {
      std::error_code ignored;
      for (const auto& file :
           std::filesystem::directory_iterator(text_in(folder, "path"), ignored)) {
        std::string name = file.path().stem().string();
        const bool is_loaded = std::find(loaded.begin(), loaded.end(), name) != loaded.end();
        if (file.path().extension() == ".so" && !is_loaded) result.push_back(std::move(name));
      }
    }
    return result;
  }

  /// "gain=" of the core that the component has: a core that replaces it has most of them too.
  Words settings(const std::string& component) {
    Words result;
    for (const std::string& address : inside(component, "properties")) {
      const auto dot = address.find(".core.");
      if (dot != std::string::npos) result.push_back(address.substr(dot + 6) + "=");
    }
    return result;
  }

 private:
  Json ask(std::string_view method, const Json& params) {
    if (!connected_) return {};
    auto answer = client_.call(method, params, within_);
    return std::holds_alternative<Json>(answer) ? std::get<Json>(std::move(answer)) : Json();
  }

  /// The row of "control.ports.scan"; null: there is none.
  static Json port_in(const Json& graph, const std::string& address) {
    for (const char* elements : {"components", "resources"}) {
      for (const Json& element : list_in(graph, elements)) {
        for (const Json& port : list_in(element, "ports")) {
          if (word(element, "name") + ".ports." + word(port, "name") == address) return port;
        }
      }
    }
    return {};
  }

  static Json items(const Json& object, const char* key) {
    return object.is_object() ? object.value(key, Json::array()) : Json::array();
  }

  Words inside(const std::string& element, std::string_view only) {
    const Json object = ask("object.get", {{"address", element}});
    Words result;
    const auto add = [&](const char* group, const std::string& prefix) {
      if (!only.empty() && only != group) return;
      for (const Json& one : items(object, group)) {
        result.push_back(element + "." + prefix + word(one, "name"));
      }
    };
    add("properties", "");
    add("observables", "");
    add("services", "");
    add("ports", "ports.");
    return result;
  }

  Client client_;
  std::chrono::milliseconds within_;
  bool connected_;
};

/// The component that was named, or nothing.
std::string component_named(const Typed& typed) {
  std::size_t index = 0;
  for (const Argument& one : typed.command->arguments) {
    if (one.is_option()) continue;
    if (index >= typed.positionals.size()) break;
    if (one.kind == Kind::component) return typed.positionals[index];
    ++index;
  }
  return {};
}

Words assignable(const Typed& typed, const std::string& begun) {
  Words words = Live(typed).addresses(begun, "properties");
  for (std::string& word : words) word += begun.find('.') == std::string::npos ? "." : "=";
  return words;
}

Words category_names() {
  Words names;
  for (const Category& one : categories()) names.emplace_back(one.name);
  return names;
}

Words command_words() {
  Words names;
  for (const Command& one : commands()) names.emplace_back(one.name);
  return names;
}

Words method_names() {
  Words names;
  for (const auto& one : protocol::methods()) names.emplace_back(one.name);
  return names;
}

Words names_of(const Typed& typed, const Argument& argument, const std::string& begun) {
  switch (argument.kind) {
    case Kind::none:
    case Kind::file:
    case Kind::duration:
    case Kind::number:
      return {};
    case Kind::command:
      return command_words();
    case Kind::method:
      return method_names();
    case Kind::available:
      return Live(typed).available_plugins();
    case Kind::setting:
      return Live(typed).settings(component_named(typed));
    case Kind::generation:
      return Live(typed).column("config.history", "generation");
    case Kind::recording:
      return Live(typed).names("trace.list");
    case Kind::category:
      return category_names();
    case Kind::component:
      return Live(typed).names("component.list");
    case Kind::core:
      return Live(typed).cores(component_named(typed));
    case Kind::port:
      return Live(typed).names("port.list");
    case Kind::plugin:
      return Live(typed).names("plugin.list");
    case Kind::explained:
      return message_names();
    case Kind::rule:
      return Live(typed).names("rules.list");
    case Kind::service:
      return Live(typed).services(typed.positionals.empty() ? "" : typed.positionals.front());
    case Kind::address:
      return Live(typed).addresses(begun);
    case Kind::assignment:
      return assignable(typed, begun);
  }
  return {};
}

/// `before` is the part of the word in front of the value: "--level=".
Completion value_completion(const Typed& typed, const Argument& argument, const std::string& begun,
                            const std::string& before) {
  Completion result;
  result.files = argument.kind == Kind::file && before.empty();
  Words values = argument.words();
  for (std::string& name : names_of(typed, argument, begun)) values.push_back(std::move(name));
  for (const std::string& value : values) result.candidates.push_back({before + value, {}});
  return result;
}

Completion command_names() {
  Completion names;
  for (const Command& one : commands()) {
    names.candidates.push_back({std::string(one.name), std::string(one.text)});
  }
  return names;
}

Completion all_completions(const Typed& typed, const std::string& begun) {
  if (typed.waiting != nullptr) return value_completion(typed, *typed.waiting, begun, {});
  if (const auto equals = begun.find('='); begun.starts_with("--") && equals != std::string::npos) {
    const Argument* option = option_called(typed.command, begun.substr(0, equals));
    if (option == nullptr || option->flag) return {};
    return value_completion(typed, *option, begun.substr(equals + 1), begun.substr(0, equals + 1));
  }
  if (begun.starts_with('-')) return {options_of(typed.command)};
  if (typed.command == nullptr) return command_names();
  const Argument* argument = next_positional(typed);
  return argument == nullptr ? Completion{} : value_completion(typed, *argument, begun, {});
}

}  // namespace

Completion complete(const std::vector<std::string>& words, std::chrono::milliseconds within) {
  if (words.empty()) return {};
  const std::string& begun = words.back();
  Typed typed = understand(words);
  typed.within = within;
  Completion result = all_completions(typed, begun);
  Candidates& all = result.candidates;
  std::erase_if(all, [&](const Candidate& one) { return !one.word.starts_with(begun); });
  std::sort(all.begin(), all.end(),
            [](const Candidate& a, const Candidate& b) { return a.word < b.word; });
  const auto same = [](const Candidate& a, const Candidate& b) { return a.word == b.word; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return result;
}

std::string completion_lines(const Completion& completion) {
  std::string lines;
  for (const auto& [word, text] : completion.candidates) {
    lines += harmless(word) + (text.empty() ? "" : "\t" + harmless(text)) + "\n";
  }
  return completion.files ? lines + ":files\n" : lines;
}

}  // namespace mauve::ctl
