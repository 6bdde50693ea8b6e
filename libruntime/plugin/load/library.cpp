// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/library.h"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>

#include "base/mutex.h"
#include "mauve/plugin.h"
#include "model/job/guard.h"
#include "plugin/elf/elf.h"
#include "plugin/elf/elf_file.h"
#include "plugin/load/prefault.h"
#include "plugin/load/system_libraries.h"

namespace mauve::plugin {

namespace {

template <std::size_t N>
std::string field_text(const char (&field)[N]) {
  return {field, strnlen(field, N)};
}

/// The dynamic linker's words, without the path that means nothing to people.
Error cannot_link(std::string text, const std::string& path) {
  constexpr std::string_view kUndefined = "undefined symbol: ";
  if (text.starts_with(path + ": ")) text.erase(0, path.size() + 2);
  if (const std::size_t at = text.find(kUndefined); at != std::string::npos) {
    const std::string symbol = text.substr(at + kUndefined.size());
    return refuse({Errc::plugin_refused, "plugin_missing_symbol"}, {},
                  "needs a symbol that nobody has: " +
                      readable_symbol(symbol.substr(0, symbol.find_first_of(" ,"))),
                  "link the source that defines it into the plugin");
  }
  constexpr std::string_view kNoFile = "cannot open shared object file";
  if (text.starts_with(kNoFile)) {  // of the plugin itself
    return refuse({Errc::plugin_refused, "plugin_not_linked"}, {},
                  "cannot be opened as " + path + ": " + text,
                  "is /proc that of this process? mount one in this container");
  }
  if (text.find(kNoFile) == std::string::npos) {
    return refuse({Errc::plugin_refused, "plugin_not_linked"}, {}, "cannot be linked: " + text);
  }
  return refuse({Errc::plugin_refused, "plugin_missing_library"}, {}, "cannot be linked: " + text,
                "install the library it needs");
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::set<std::string> loaded_objects() {
  std::set<std::string> names;
  dl_iterate_phdr(
      [](dl_phdr_info* object, std::size_t /*size*/, void* into) {
        static_cast<std::set<std::string>*>(into)->insert(object->dlpi_name);
        return 0;
      },
      &names);
  return names;
}

/// A library that came with the plugin is not in its file: a reload would go on with the old code,
/// and who overwrites it ends mauved with SIGBUS. One that an earlier plugin left behind is none of
/// the program either.
Status check_companions(const std::set<std::string>& before, const std::string& plugin,
                        const std::vector<std::string>& needed) {
  static const std::set<std::string> of_the_program = before;
  for (const std::string& object : loaded_objects()) {
    const bool needs = std::ranges::count(needed, object.substr(object.rfind('/') + 1)) > 0;
    if (object == plugin || is_of_the_system(object) || of_the_program.contains(object)) continue;
    if (before.contains(object) && !needs) continue;
    return refuse({Errc::plugin_refused, "plugin_needs_library"}, {},
                  "needs " + object + ", which is not a library of the system",
                  "link its sources, or a static library, into the plugin: a reload renews the "
                  "code of the plugin alone");
  }
  return ok();
}

bool is_data_type(const std::string& user) { return user.starts_with("data type "); }

}  // namespace

Result<std::shared_ptr<Library>> Library::open(const PluginFile& file) {
  const auto refused = [&](Error error) {
    if (error.at.empty()) error.at = file.path;
    return error;
  };
  Result<Facts> facts = inspect(file.bytes, file.name);
  if (!facts) return refused(facts.error());

  const std::shared_ptr<Library> library(new Library);
  PluginInfo& info = library->info_;
  info = {file.name,
          field_text(facts->manifest.version),
          field_text(facts->manifest.compiler),
          facts->build_id,
          file.path,
          0,
          facts->warnings};
  for (const std::string& hidden : file.hides) {
    info.warnings.push_back(file.path + " is loaded, and not " + hidden +
                            ": its directory is named first");
  }
  Result<Image> image =
      Image::seal(file.bytes, info.name + "-" + info.version + "-" + facts->build_id.substr(0, 8));
  if (!image) return refused(image.error());
  library->image_ = *std::move(image);
  info.serial = library->image_.serial();
  if (Status mapped = library->map(*facts, file.name); !mapped) {
    return refused(mapped.error());
  }
  if (Status good = library->declare(facts->manifest); !good) return refused(good.error());
  return library;
}

std::shared_ptr<Library> Library::compiled_in(Plugin plugin) {
  std::shared_ptr<Library> library(new Library);
  library->info_.name = plugin.name();
  library->info_.version = kVersion;
  library->declared_ = std::make_unique<Plugin>(std::move(plugin));
  return library;
}

Status Library::map(const Facts& facts, const std::string& name) {
  const std::string path = image_.path();
  const std::set<std::string> before = loaded_objects();
  handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) return cannot_link(dlerror(), path);
  if (Status alone = check_companions(before, path, facts.needed); !alone) return alone;
  code_ = rt::code_around(dlsym(handle_, "mauve_plugin"));
  declared_ = std::make_unique<Plugin>(name, facts.manifest.checksum);
  return ok();
}

Status Library::declare(const PluginManifest& checked) {
  const auto* entry = static_cast<const PluginEntry*>(dlsym(handle_, "mauve_plugin"));
  if (entry == nullptr || std::memcmp(&entry->manifest, &checked, sizeof checked) != 0 ||
      entry->declare == nullptr) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                  "is damaged: its entry is not the one in its manifest", "build or copy it again");
  }
  Status declared = call_hook(info_.name, "its MAUVE_PLUGIN block", [&] {
    entry->declare(*declared_);
    return ok();
  });
  if (!declared) {
    declared.error().at.clear();  // open() names the file instead
    return declared;
  }
  prefault(entry);
  return ok();
}

Library::~Library() {
  declared_.reset();
  if (handle_ == nullptr) return;
  if (!rt::threads_started_by(code_).empty()) {
    image_.abandon();
    return;
  }
  dlclose(handle_);
  if (is_mapped(image_.mapping())) image_.abandon();
}

std::vector<std::string> Library::users() const {
  const MutexLock lock(mutex_);
  std::vector<std::string> found;
  for (const User& user : users_) {
    found.push_back(user.address.empty() ? user.name : user.address + " (" + user.name + ")");
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Unmapped Library::release(std::shared_ptr<Library> library) {
  if (!library) return {true, {}};
  if (library->handle_ == nullptr) return {false, "it is part of the program"};
  const std::vector<std::string> users = library->users();
  const std::string held_by = joined(users);
  const bool types_only = !users.empty() && std::ranges::all_of(users, is_data_type);
  const std::string mapping = library->image_.mapping();
  const rt::CodeRange code = library->code_;
  const std::weak_ptr<Library> rest = library;
  library.reset();
  if (!rest.expired()) {
    return {false,
            held_by.empty() ? "something that was made by it is still in use"
                            : "still used by " + held_by,
            types_only};
  }
  if (const auto left = rt::threads_started_by(code); !left.empty()) {
    return {false, "it left " + std::to_string(left.size()) +
                       (left.size() == 1 ? " thread" : " threads") + " running: " + joined(left) +
                       " (end them in on_cleanup)"};
  }
  if (is_mapped(mapping)) return {false, "the dynamic linker keeps it for the life of the process"};
  return {true, {}};
}

}  // namespace mauve::plugin
