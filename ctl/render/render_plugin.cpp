// SPDX-License-Identifier: LGPL-3.0-or-later
#include <array>
#include <string>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

/// "drivers/laser_sim" is "laser_sim" in the row of the plugin "drivers".
std::string own_name(std::string name, const std::string& plugin) {
  return name.starts_with(plugin + "/") ? name.substr(plugin.size() + 1) : name;
}

std::string warnings_of(const Json& plugin, const std::string& name, Look look) {
  std::string text;
  for (const Json& warning : list_in(plugin, "warnings")) {
    text += painted("warning:", Paint::yellow, look.colour) + " " + name + ": " + compact(warning) +
            "\n";
  }
  return text;
}

constexpr std::size_t kShortBuild = 8;

/// The build that runs, and on a line of its own the build that would be loaded next.
std::string builds_of(const Json& plugin, Look look) {
  const std::string runs = word(plugin, "build_id").substr(0, kShortBuild);
  const Json& on_disk = member(plugin, "build_on_disk");
  const bool other = plugin.contains("build_on_disk");
  std::string text = runs.empty() ? "" : " (build " + runs + ")";
  if (const auto users = whole_number(plugin, "users"); users > 0) {
    text += ", " + counted(users, "object") + " in use";
  }
  text += "\n";
  if (!other) return text;
  const std::string reload = "mauvectl reload " + word(plugin, "name");
  const std::string line =
      on_disk.is_null()
          ? "  no build can be loaded from its file now, so a start would fail: " + reload +
                " --dry-run says why"
          : "  its file holds build " + compact(on_disk).substr(0, kShortBuild) +
                ", which the next start, or " + reload + ", loads";
  return text + painted(wrapped(harmless(line), look.width, 4), Paint::yellow, look.colour) + "\n";
}

}  // namespace

std::string render_plugin(std::string_view done, const Json& result, Look look) {
  std::string text(done);
  if (word(result, "unmapped") == "true") text += ", the old code is out of memory";
  return render_receipt(text, result, look);
}

std::string render_plugins(const Json& result, Look look) {
  constexpr std::array<const char*, 5> kKinds{"components", "cores", "fsms", "resources", "types"};
  const Json& items = list_in(result, "items");
  if (items.empty()) return "none\n";
  std::string text;
  for (const Json& plugin : items) {
    const std::string name = word(plugin, "name");
    text += painted(name, Paint::bold, look.colour) + " " + word(plugin, "version") +
            builds_of(plugin, look);
    for (const char* kind : kKinds) {
      std::string names;
      for (const Json& one : list_in(plugin, kind)) {
        join(names, own_name(compact(one), name));
      }
      if (names.empty()) continue;
      std::string line = "  " + std::string(kind);
      line.append(14 - line.size(), ' ').append(names);
      text += wrapped(line, look.width, 14) + "\n";
    }
    text += warnings_of(plugin, name, look);
  }
  return text;
}

std::string render_plugins_for(const Json& result, Look look) {
  const Json& items = list_in(result, "items");
  if (items.empty()) return "none\n";
  Table table({{"CORE"}, {"PLUGIN"}, {"VERSION"}});
  for (const Json& plugin : items) {
    for (const Json& core : list_in(plugin, "cores")) {
      table.add({{compact(core)}, {word(plugin, "name")}, {word(plugin, "version")}});
    }
  }
  return table.text(look.width, look.colour);
}

}  // namespace mauve::ctl
