// SPDX-License-Identifier: LGPL-3.0-or-later
#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <sstream>

#include "base/duration.h"
#include "mauve/host/version.h"
#include "plugin/load/plugin_file.h"
#include "protocol/socket_path.h"

namespace mauve::daemon {

namespace {

constexpr int kWrongUse = 2;

const std::map<std::string, Realtime> kRealtime = {
    {"require", Realtime::require}, {"prefer", Realtime::prefer}, {"off", Realtime::off}};
const std::map<std::string, rt::GuardianUse> kGuardian = {{"require", rt::GuardianUse::require},
                                                          {"prefer", rt::GuardianUse::prefer},
                                                          {"off", rt::GuardianUse::off}};
const std::map<std::string, Admission> kAdmission = {
    {"strict", Admission::strict}, {"warn", Admission::warn}, {"off", Admission::off}};
const std::map<std::string, logging::Level> kLevels = {{"debug", logging::Level::debug},
                                                       {"info", logging::Level::info},
                                                       {"warn", logging::Level::warn},
                                                       {"error", logging::Level::error}};

/// Of a service, the first of the directories that its manager made for it.
std::string default_state_dir() {
  const char* given = std::getenv("STATE_DIRECTORY");
  const std::string all = given == nullptr ? "" : given;
  return all.substr(0, all.find(':'));
}

/// A word out of a map; CLI11 has checked that it is there.
template <typename T>
std::function<void(const std::string&)> chosen(const std::map<std::string, T>& words, T& into) {
  return [&words, &into](const std::string& word) { into = words.at(word); };
}

/// The names of --machine.
const std::map<std::string, Duration MachineCosts::*, std::less<>> kCosts = {
    {"wake", &MachineCosts::wake},
    {"switch", &MachineCosts::activation},
    {"timer", &MachineCosts::interrupt},
    {"kernel", &MachineCosts::kernel}};

/// "wake=20us,kernel=10us": the other costs stay. Returns the mistake in the text; empty: none.
std::string read_machine(const std::string& text, MachineCosts& costs) {
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto equals = part.find('=');
    const auto cost = kCosts.find(part.substr(0, equals));
    if (equals == std::string::npos || cost == kCosts.end()) {
      return "'" + part + "' is none of wake=, switch=, timer=, kernel= and a duration";
    }
    const auto time = parse_duration(part.substr(equals + 1));
    if (!time) {
      return part + ": " + time.error().message + ", " + time.error().hint;
    }
    if (*time >= MachineCosts::window) {
      return part + ": must be less than " + format_duration(MachineCosts::window);
    }
    costs.*cost->second = *time;
  }
  return "";
}

/// The refusal that CLI11 prints; empty: none.
std::string is_a_machine(const std::string& text) {
  MachineCosts costs;
  return text.empty() ? "names no cost" : read_machine(text, costs);
}

std::string machine_text() {
  std::string text;
  for (const auto& [name, cost] : kCosts) {
    text += (text.empty() ? "" : ",") + name + "=" + format_duration(MachineCosts{}.*cost);
  }
  return text;
}

/// The message of CLI11 for a time that is refused.
std::string is_some_time(const std::string& text) {
  const auto time = parse_duration(text);
  if (!time) {
    return time.error().message + ", " + time.error().hint;
  }
  return *time > Duration{0} ? "" : "must be more than zero";
}

void declare_guardian(CLI::App& app, Options& options) {
  app.add_option_function(
         "--guardian", chosen(kGuardian, options.guardian),
         "Outputs that are to be safe also when mauved is killed: require refuses them without a "
         "guardian, prefer says so, off looks for none (in a debugger)")
      ->type_name("require|prefer|off")
      ->check(CLI::IsMember(kGuardian))
      ->default_str("prefer");
}

void declare_admission(CLI::App& app, Options& options) {
  app.add_option_function("--admission", chosen(kAdmission, options.admission),
                          "What is not proved to meet its deadlines: strict refuses it, warn says "
                          "so, off does not look")
      ->type_name("strict|warn|off")
      ->check(CLI::IsMember(kAdmission))
      ->default_str("warn");
  app.add_option_function<std::string>(
         "--machine",
         [&options](const std::string& text) {
           static_cast<void>(read_machine(text, options.machine));
         },
         "The costs of the machine that admission assumes: to wake a thread up, to switch to it "
         "and "
         "back, of a timer, and of kernel and host in each 4ms. mauvectl analyze compares them "
         "with measurements, mauvectl doctor --wake 10s proposes values")
      ->type_name("COSTS")
      ->check(is_a_machine, "", "COSTS")
      ->default_str(machine_text());
}

/// The options for files that outlive a run.
void declare_records(CLI::App& app, Options& options) {
  app.add_option("--log-file", options.log_file, "Also write the log as JSON lines to this file")
      ->type_name("FILE");
  app.add_option("--state-dir", options.state_dir,
                 "Keep generations and the audit log here; else in $STATE_DIRECTORY")
      ->type_name("DIR");
  app.add_flag(
      "--fresh", options.fresh,
      "Start the file, also after a crash, and not the newest confirmed generation; the stops "
      "of users end");
  app.add_option_function<std::string>(
         "--flight-recorder",
         [&options](const std::string& text) { options.flight_recorder = text == "on"; },
         "on traces always, and keeps the seconds before a missed release, a fault or a rollback "
         "in the state directory")
      ->type_name("on|off")
      ->check(CLI::IsMember({"on", "off"}))
      ->default_str("on");
}

void declare(CLI::App& app, Options& options) {
  app.name("mauved");
  app.footer(
      "Examples:\n"
      "  mauved /usr/share/mauve/rover.json\n"
      "  mauved --check my.json\n"
      "  mauved /etc/mauve/architecture.json --realtime require");
  app.set_version_flag("--version", "mauved " MAUVE_VERSION);
  app.add_option("architecture", options.architecture, "The architecture file (JSON)")
      ->required()
      ->type_name("ARCHITECTURE.json");
  app.add_option("--socket", options.socket,
                 "The admin socket; else $MAUVE_SOCKET; else /run/mauve/mauved.sock of root, and "
                 "$XDG_RUNTIME_DIR/mauve/mauved.sock of other users")
      ->type_name("PATH");
  app.add_option("--plugin-dir", options.plugin_dirs,
                 "Load plugins from this directory and the others given, and from nowhere else; "
                 "without it from lib/mauve/plugins beside the folder of mauved")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_option("--allow-path", options.path_dirs,
                 "A request may also set a property that is a path to one in this directory; the "
                 "architecture file may always")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_option_function(
         "--realtime", chosen(kRealtime, options.realtime),
         "Without real-time privileges: require refuses to start, prefer warns, off does "
         "not ask for them")
      ->type_name("require|prefer|off")
      ->check(CLI::IsMember(kRealtime))
      ->default_str("prefer");
  declare_guardian(app, options);
  declare_admission(app, options);
  app.add_option_function<std::string>(
         "--prepare-within",
         [&options](const std::string& text) { options.prepare_within = *parse_duration(text); },
         "Give a change up whose hooks (constructors, configure) take longer; what runs runs on")
      ->type_name("DURATION")
      ->check(is_some_time, "", "DURATION")
      ->default_str("10s");
  app.add_flag("--check", options.check, "Only say what is wrong with the file; needs no root");
  app.add_flag("--judge", options.judge,
               "mauved runs itself so, in a process with limits, to look at the files of clients");
  declare_records(app, options);
  app.add_option_function("--log-level", chosen(kLevels, options.log_level),
                          "Report this and worse")
      ->type_name("debug|info|warn|error")
      ->check(CLI::IsMember(kLevels))
      ->default_str("info");
}

Leave leave(const CLI::App& app, const CLI::ParseError& error) {
  const bool asked = error.get_exit_code() == 0;
  if (!asked) {
    return {kWrongUse, std::string("error: ") + error.what() + "\nhint: mauved --help\n"};
  }
  const auto* version = dynamic_cast<const CLI::CallForVersion*>(&error);
  return {0, version != nullptr ? std::string(error.what()) + "\n" : app.help()};
}

void make_absolute(Options& options) {
  const auto absolute = [](std::string& path) {
    std::error_code failed;
    if (auto whole = std::filesystem::absolute(path, failed); !path.empty() && !failed) {
      path = whole.lexically_normal().string();
    }
  };
  absolute(options.socket);
  absolute(options.log_file);
  absolute(options.state_dir);
  std::ranges::for_each(options.plugin_dirs, absolute);
  std::ranges::for_each(options.path_dirs, absolute);
}

}  // namespace

std::vector<OptionText> option_texts() {
  CLI::App app;
  Options options;
  declare(app, options);
  std::vector<OptionText> texts;
  for (const CLI::Option* option : app.get_options()) {
    // CLI11 adds its check after a colon.
    const std::string type = option->get_type_name();
    const bool takes_value = option->get_items_expected_max() > 0;
    texts.push_back({option->get_name(false, true),
                     takes_value ? type.substr(0, type.find(':')) : "", option->get_description(),
                     option->get_default_str()});
  }
  return texts;
}

std::variant<Options, Leave> parse_options(int argc, const char* const* argv) {
  CLI::App app{"Runs an architecture on real-time threads and lets mauvectl change it."};
  Options options;
  declare(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return leave(app, error);
  }
  if (options.socket.empty()) {
    options.socket = protocol::default_socket_path();
  }
  if (options.plugin_dirs.empty()) {
    options.plugin_dirs = {plugin::installed_directory()};
  }
  if (options.state_dir.empty()) {
    options.state_dir = default_state_dir();
  }
  make_absolute(options);
  return options;
}

const std::string& word_of(Realtime realtime) {
  return std::ranges::find(kRealtime, realtime, [](const auto& row) { return row.second; })->first;
}

}  // namespace mauve::daemon
