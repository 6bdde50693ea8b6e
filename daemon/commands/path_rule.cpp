// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/path_rule.h"

#include "base/terminal_text.h"
#include "base/thread_role.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace mauve::daemon {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(std::move(word));
  }
  return words;
}

/// "/dev/" and "./", but not "pty:".
bool is_directory(const std::string& place) { return place.ends_with('/'); }

/// A name that goes into one directory must not lead out of it.
bool is_name_in(const std::string& text, const std::string& place) {
  return text.starts_with(place) && text.find('/') == std::string::npos;
}

bool lies_in(const fs::path& path, const std::string& directory) {
  std::error_code failed;
  const auto whole = fs::weakly_canonical(fs::absolute(directory, failed), failed);
  if (failed) {
    return false;
  }
  const auto inside = path.lexically_relative(whole);
  return !inside.empty() && inside != "." && *inside.begin() != "..";
}

/// Below /dev, but every user may put links there, and exchange a file for one after this look.
bool is_shared(const fs::path& path) {
  return lies_in(path, "/dev/shm") || lies_in(path, "/dev/mqueue");
}

std::string listed(const std::vector<std::string>& places) {
  std::string list;
  for (const auto& place : places) {
    list +=
        (list.empty() ? "" : " or ") + (place == "./" ? "the folder of the architecture" : place);
  }
  return list;
}

}  // namespace

Status lies_within(const PropertyBase& property, const Value& value,
                   const std::vector<std::string>& more) {
  MAUVE_ON_THREAD(factory);
  const auto* text = value.get_if<std::string>();
  if (property.within().empty() || text == nullptr || text->empty()) {
    return ok();
  }
  auto places = words_of(property.within());
  const auto is_name = [&](const auto& place) {
    return !is_directory(place) && is_name_in(*text, place);
  };
  if (std::ranges::any_of(places, is_name)) {
    return ok();
  }
  std::error_code failed;
  const bool cut = text->find('\0') != std::string::npos;
  const auto path = fs::weakly_canonical(fs::absolute(*text, failed), failed);
  const auto holds = [&](const auto& directory) { return lies_in(path, directory); };
  if (!failed && !cut &&
      (std::ranges::any_of(more, holds) || std::ranges::any_of(places, [&](const auto& place) {
         return is_directory(place) && holds(place) && !is_shared(path);
       }))) {
    return ok();
  }
  if (!failed && is_shared(path)) {
    return refuse(
        {Errc::not_permitted, "path_not_allowed"}, property.address(),
        "'" + beginning_of(*text) + "' lies where every user may exchange a file for a link",
        "name a device, or let mauved allow the directory: --allow-path DIR");
  }
  places.insert(places.end(), more.begin(), more.end());
  return refuse({Errc::not_permitted, "path_not_allowed"}, property.address(),
                "'" + beginning_of(*text) + "' is outside of " + listed(places),
                "other paths are named in the architecture file, or allowed by mauved "
                "--allow-path DIR");
}

std::function<Status(const PropertyBase&, const Value&)> path_rule(std::vector<std::string> more) {
  return [more = std::move(more)](const PropertyBase& property, const Value& value) {
    return lies_within(property, value, more);
  };
}

}  // namespace mauve::daemon
