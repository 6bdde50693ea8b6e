// SPDX-License-Identifier: LGPL-3.0-or-later
/// new: writes a project that builds and passes its test, from the installed example of its kind.
/// There is one source: the example, in which the name of its plugin is replaced.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/files.h"
#include "commands/actions.h"

namespace mauve::ctl {
namespace {

namespace fs = std::filesystem;
using protocol::fault_of;

struct ProjectKind {
  std::string_view kind;
  std::string_view example;  ///< folder below share/mauve/examples
  std::string_view plugin;   ///< the name in the example; no text for people contains it
};
constexpr ProjectKind kKinds[] = {{"core", "core", "homing"},
                                  {"component", "component", "tracker"},
                                  {"resource", "resource", "water_tank"},
                                  {"driver", "serial_driver", "serial_heater"}};

constexpr std::size_t kLongestName = 64;  // as mauve_add_plugin() accepts it

/// Words that are no namespace or no target of CMake, a blank around each.
constexpr std::string_view kReserved =
    " alignas alignof all and asm auto bool break case catch char class clean concept const "
    "continue default delete do double else enum explicit export extern false float for friend "
    "goto guidance help if inline install int long mauve mutable namespace new noexcept not "
    "nullptr operator or package private protected public register requires return rover short "
    "signed sizeof static std struct switch template test this throw true try typedef typeid "
    "typename union unsigned using virtual void volatile while xor ";

bool is_name(std::string_view name) {
  const auto fits = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '_';
  };
  return !name.empty() && name.size() <= kLongestName && name.front() >= 'a' &&
         name.front() <= 'z' && std::ranges::all_of(name, fits) && !name.ends_with('_') &&
         name.find("__") == name.npos;
}

/// The prefix that this program is installed in; the folder of a build looks alike.
fs::path prefix() {
  std::error_code failed;
  return fs::read_symlink("/proc/self/exe", failed).parent_path().parent_path();
}

Status check(const std::string& name) {
  if (!is_name(name)) {
    return refuse({Errc::invalid_value, "plugin_name_invalid"}, name, "this is no name of a plugin",
                  "begin with a small letter, go on with small letters, digits and single _, "
                  "such as my_core");
  }
  if (kReserved.find(" " + name + " ") != kReserved.npos) {
    return refuse({Errc::invalid_value, "plugin_name_invalid"}, name,
                  "this word has a meaning in C++, CMake or mauve",
                  "take another one, such as my_" + name);
  }
  std::error_code failed;
  if (fs::exists(fs::symlink_status(name, failed))) {
    return refuse({Errc::duplicate, "file_exists"}, name,
                  "there is a file or folder of this name already",
                  "take another name, or go to another folder");
  }
  return ok();
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != text.npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// Files of the example that a project begins with: all but its page, and none that a build made.
std::vector<fs::path> files_of(const fs::path& example) {
  std::error_code failed;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(example, failed)) {
    if (entry.is_regular_file() && entry.path().extension() != ".md") files.push_back(entry);
  }
  std::ranges::sort(files);
  return files;
}

/// An editor that knows JSON schemas completes the keys of the file.
std::string with_schema(const std::string& text) {
  const fs::path schema = prefix() / "share/mauve/architecture.schema.json";
  return "{\n  \"$schema\": \"file://" + schema.string() + "\"," + text.substr(1);
}

Status copy(const fs::path& file, const ProjectKind& kind, const std::string& name) {
  auto stream = open_to_read(file);
  if (!stream) return stream.error();
  std::string text{std::istreambuf_iterator<char>(*stream), {}};
  if (file.filename() == "architecture.json" && text.starts_with('{')) text = with_schema(text);
  const fs::path to = fs::path(name) / replaced(file.filename(), kind.plugin, name);
  return write_file(to, [&](std::ostream& out) { out << replaced(text, kind.plugin, name); });
}

/// The folder is new, so all that is in it is ours: nothing stays of a project that is incomplete.
Status write(const std::vector<fs::path>& files, const ProjectKind& kind, const std::string& name) {
  std::error_code failed;
  if (!fs::create_directory(name, failed)) {
    return refuse({Errc::system, "file_not_written"}, name,
                  "the folder cannot be made: " + failed.message());
  }
  for (const fs::path& file : files) {
    Status done = copy(file, kind, name);
    if (done) continue;
    fs::remove_all(name, failed);
    return done;
  }
  return ok();
}

std::vector<std::string> next_commands(const ProjectKind& kind, const std::string& name) {
  std::vector<std::string> all = {
      "cd " + name,
      "cmake -B build -DCMAKE_PREFIX_PATH=\"" + prefix().string() + "\" && cmake --build build",
      "ctest --test-dir build"};
  if (kind.kind == "core") {  // it runs in the robot that mauve brings
    const std::string mauve = prefix().string();
    all.push_back("mauved \"" + mauve + "/share/mauve/yard.json\" --plugin-dir \"" + mauve +
                  "/lib/mauve/plugins\" --plugin-dir build >mauved.log 2>&1 &");
    all.push_back("mauvectl load " + name);
    all.push_back("mauvectl swap-core control " + name + "/straight");
  } else {
    all.push_back("mauved architecture.json --plugin-dir build");
  }
  return all;
}

int print_written(Session& session, const ProjectKind& kind, const std::string& name,
                  std::size_t files) {
  std::string text = "written: " + name + ", a project with " + std::to_string(files) +
                     " files; the next commands:\n";
  Json next = Json::array();
  for (const std::string& command : next_commands(kind, name)) {
    text += "  " + command + "\n";
    next.push_back(command);
  }
  const fs::path page = prefix() / "share/mauve/examples" / kind.example / "README.md";
  session.print({{"folder", name}, {"next", std::move(next)}, {"page", page.string()}},
                text + "The project is explained in " + page.string() + "\n");
  return 0;
}

}  // namespace

int run_new(Session& session) {
  const std::string name = session.arguments.one("NAME");
  // The table of arguments has the same kinds, so the parser has refused all others.
  const auto* kind = std::ranges::find(kKinds, session.arguments.one("KIND"), &ProjectKind::kind);
  if (const Status good = check(name); !good) return session.fail(fault_of(good.error()));
  const fs::path example = prefix() / "share/mauve/examples" / kind->example;
  const std::vector<fs::path> files = files_of(example);
  if (files.empty()) {
    return session.fail(fault_of(
        refuse({Errc::system, "examples_missing"}, example, "the examples are not installed",
               "install the package mauve-dev, or mauve with cmake --install")));
  }
  if (const Status done = write(files, *kind, name); !done) {
    return session.fail(fault_of(done.error()));
  }
  return print_written(session, *kind, name, files.size());
}

}  // namespace mauve::ctl
