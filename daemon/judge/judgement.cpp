// SPDX-License-Identifier: LGPL-3.0-or-later
#include "judge/judgement.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "arch/build/build.h"
#include "arch/build/check_rules.h"
#include "arch/build/load.h"
#include "arch/compare/diff_rules.h"
#include "arch/parse/parse.h"
#include "arch/text/value_json.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

/// An architecture and its rules, not configured.
struct Made {
  std::unique_ptr<Architecture> architecture;
  rules::Supervision supervision;
  std::vector<Wiring::Note> notes;  ///< as a start of the file logs them
};

bool is_loaded(const Question& question, const std::string& plugin) {
  return std::ranges::find(question.loaded, plugin) != question.loaded.end();
}

/// A plugin that the caller may not load is an error at its place in the file, and is not loaded.
void leave_out_unloaded(const Question& question, arch::Spec& spec, arch::Problems& problems) {
  if (question.loads) {
    return;
  }
  std::erase_if(spec.plugins, [&](const arch::PlacedText& plugin) {
    if (is_loaded(question, plugin.value)) {
      return false;
    }
    problems.add(plugin.where,
                 refuse({Errc::not_permitted, "plugin_not_yours"}, "plugins." + plugin.value,
                        "is not loaded, and its code runs for nobody but an admin",
                        "ask an admin to check the file or to load the plugin; mauved --check FILE "
                        "looks at it with your own rights"));
    return true;
  });
}

Made make(const Question& question, plugin::Catalog& catalog, arch::Problems& problems) {
  Made made;
  auto spec = arch::parse(question.text, problems);
  if (spec) {
    leave_out_unloaded(question, *spec, problems);
    arch::load_plugins(*spec, catalog, problems);
    made.architecture =
        arch::build(*spec, catalog, problems, &made.supervision,
                    question.ran ? arch::LostNames::kept : arch::LostNames::refused);
  }
  if (problems.empty()) {
    made.notes = arch::notes_on_file(made.supervision, *made.architecture, catalog);
  }
  return made;
}

Result<Made> make_running(const std::string& text, plugin::Catalog& catalog) {
  Made made;
  arch::Problems problems;
  made.architecture = arch::load(text, catalog, problems, &made.supervision, arch::LostNames::kept);
  if (problems.empty()) {
    made.notes = arch::notes_on_file(made.supervision, *made.architecture, catalog);
    return made;
  }
  const auto first = problems.sorted().front().error;
  return refuse(
      {Errc::wrong_state, "plugin_files_changed"}, first.at,
      "what runs cannot be made again from the plugin files of now: " + first.message,
      "the files have changed since they were loaded: mauvectl reload takes the new ones");
}

void compare(const Question& question, const Made& running, Made& wanted,
             const plugin::Catalog& catalog, Json& result) {
  auto lines = Json::array();
  for (const auto* plugin : catalog.plugins()) {
    const auto& name = plugin->info().name;
    if (!is_loaded(question, name)) {
      lines.push_back(to_json(arch::make_line("plugin", name, {}, name)));
    }
  }
  const auto difference = arch::compare(*running.architecture, *wanted.architecture);
  for (const auto& line : difference.lines) {
    lines.push_back(to_json(line));
  }
  for (const auto& line : arch::compare(running.supervision, wanted.supervision)) {
    lines.push_back(to_json(line));
  }
  for (const auto& note : wanted.notes) {
    if (std::ranges::find(running.notes, note) == running.notes.end()) {
      result["notes"].push_back(to_string(note));
    }
  }
  result["same"] = lines.empty();
  result["lines"] = std::move(lines);
  if (!difference.exchanged.empty()) {
    result["exchanged"] = difference.exchanged;
  }
  for (const auto& one : other_builds(question.builds, catalog)) {
    result["notes"].push_back(one.plugin + " runs build " + short_build(one.recorded) +
                              ", and its file holds build " + short_build(one.runs) +
                              ", which the next start, or mauvectl reload " + one.plugin +
                              ", loads");
  }
}

Json cores_of(const Architecture& architecture, const plugin::Catalog& catalog) {
  auto cores = Json::array();
  for (const auto* component : architecture.components()) {
    const auto& core = component->bundle()->core_type.name;
    const auto* loaded = catalog.find(core.substr(0, core.find('/')));
    cores.push_back({{"component", component->name()},
                     {"core", core},
                     {"build_id", loaded == nullptr ? "" : loaded->info().build_id}});
  }
  return cores;
}

}  // namespace

Json to_json(const Question& question) {
  Json json{
      {"text", question.text},   {"loaded", question.loaded},           {"builds", question.builds},
      {"loads", question.loads}, {"lists_cores", question.lists_cores}, {"ran", question.ran}};
  if (question.running) {
    json["running"] = *question.running;
  }
  return json;
}

std::optional<Question> question_of(const std::string& text) {
  const auto json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("text")) {
    return std::nullopt;
  }
  Question question{json["text"],
                    std::nullopt,
                    json.value("loaded", std::vector<std::string>()),
                    json.value("builds", Builds()),
                    json.value("loads", false),
                    json.value("lists_cores", false),
                    json.value("ran", false)};
  if (json.contains("running")) {
    question.running = json["running"];
  }
  return question;
}

Result<Json> judge(const Question& question, plugin::Catalog catalog) {
  arch::Problems problems;
  auto wanted = make(question, catalog, problems);
  Json result{{"errors", to_json(problems)}};
  if (problems.empty() && question.lists_cores) {
    result["cores"] = cores_of(*wanted.architecture, catalog);
  }
  if (!question.running) {
    for (const auto& note : wanted.notes) {
      result["notes"].push_back(to_string(note));
    }
  }
  if (problems.empty() && question.running) {
    const auto running = make_running(*question.running, catalog);
    if (!running) {
      return running.error();
    }
    compare(question, *running, wanted, catalog, result);
  }
  return result;
}

Json to_json(const arch::Problems& problems) {
  constexpr std::size_t kMost = 200;  // a file of 1 MiB can have a hundred thousand
  Json errors = Json::array();
  for (const auto& problem : problems.sorted()) {
    if (errors.size() == kMost) {
      errors.push_back(
          {{"line", problem.where.line},
           {"column", problem.where.column},
           {"at", problem.error.at},
           {"code", to_string(Errc::limit)},
           {"message", "and " + std::to_string(problems.size() - kMost) + " more errors"},
           {"hint", "correct the first ones"}});
      break;
    }
    errors.push_back({{"line", problem.where.line},
                      {"column", problem.where.column},
                      {"at", problem.error.at},
                      {"code", to_string(problem.error.code)},
                      {"message", problem.error.message},
                      {"hint", problem.error.hint},
                      {"id", problem.error.id}});
  }
  return errors;
}

Json to_json(const arch::Line& line) {
  return {{"op", to_string(line.op)},
          {"kind", line.kind},
          {"address", line.address},
          {"old", arch::to_json(line.before)},
          {"new", arch::to_json(line.after)}};
}

std::vector<arch::Line> lines_of(const Json& lines) {
  const auto value = [](const Json& json) {
    auto read = arch::from_json(json);
    return read ? *std::move(read) : Value();
  };
  std::vector<arch::Line> all;
  for (const auto& line : lines) {
    all.push_back(
        arch::make_line(line["kind"], line["address"], value(line["old"]), value(line["new"])));
  }
  return all;
}

}  // namespace mauve::daemon
