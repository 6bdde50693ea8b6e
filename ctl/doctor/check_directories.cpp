// SPDX-License-Identifier: LGPL-3.0-or-later
/// Directories: those of the plugins, of the socket, and of the state that outlives a run.
#include <sys/stat.h>

#include <cstdio>

#include "doctor/checks.h"
#include "render/words.h"

namespace mauve::ctl::doctor {
namespace {

constexpr double kMebibyte = 1024.0 * 1024.0;
constexpr double kScarce = 256 * kMebibyte;  // some days of an audit log, and a hundred generations
constexpr double kFull = 4 * kMebibyte;

std::string octal(std::uint64_t mode) {
  char text[16];
  std::snprintf(text, sizeof text, "%04o", static_cast<unsigned>(mode & 07777U));
  return text;
}

std::string listed(const Json& directory) {
  return word(directory, "path") + " (user " + word(directory, "uid") + ", mode " +
         octal(whole_number(directory, "mode")) + ")";
}

bool anybody_writes(std::uint64_t mode) { return (mode & 0002U) != 0 && (mode & 01000U) == 0; }

std::string size_of(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f MiB", bytes / kMebibyte);
  return text;
}

}  // namespace

Finding check_plugins(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  std::string sound;
  std::string absent;
  std::string unsound;
  std::string remedy;
  for (const Json& directory : list_in(facts.daemon, "plugin_dirs")) {
    if (word(directory, "exists") != "true") {
      join(absent, word(directory, "path"));
    } else if (directory.contains("problem")) {
      join(unsound, word(directory, "path") + " " + word(directory, "problem"));
      join(remedy, word(directory, "hint"), "; ");
    } else {
      join(sound, listed(directory));
    }
  }
  if (!unsound.empty()) return bad("nothing is loaded from " + unsound, remedy);
  if (!absent.empty())
    return doubt("there is no " + absent + ", so no plugin is found there",
                 "mkdir --parents " + absent);
  return good(sound);
}

Finding check_trust(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  std::string unsound;
  std::string remedy;
  for (const Json& path : list_in(facts.daemon, "distrusted")) {
    const std::string one = word(path, "path") + " " + word(path, "problem");
    if (unsound.find(one) != std::string::npos) continue;
    join(unsound, one, "; ");
    if (remedy.find(word(path, "hint")) == std::string::npos) {
      join(remedy, word(path, "hint"), "; ");
    }
  }
  if (unsound.empty()) {
    return good("nobody else may exchange architecture file, state directory or socket");
  }
  return doubt(unsound, remedy.empty() ? "see to its owner and mode" : remedy);
}

Finding check_socket(const Facts& facts) {
  const std::filesystem::path socket(facts.socket);
  const auto below = facts.root / socket.relative_path();
  struct stat its {};
  struct stat folder {};
  if (stat(below.c_str(), &its) != 0) return good("there is no " + facts.socket);
  const std::string parent = socket.parent_path().string();
  const bool seen = stat(below.parent_path().c_str(), &folder) == 0;
  if (seen && anybody_writes(folder.st_mode)) {
    return bad(
        "everybody may replace what is in " + parent + " (mode " + octal(folder.st_mode) + ")",
        "chmod 0750 " + parent);
  }
  if ((its.st_mode & 0007U) != 0) {
    return doubt(facts.socket + " is open to everybody (mode " + octal(its.st_mode) +
                     "), so only the roles of mauved keep users out",
                 "chmod 0660 " + facts.socket);
  }
  return good(facts.socket + " (mode " + octal(its.st_mode) + ") in a directory of mode " +
              octal(folder.st_mode));
}

Finding check_state(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  const Json state = facts.daemon.value("state_dir", Json());
  if (state.is_null()) {
    return doubt("none: after a crash the file is started, and there is no history",
                 "start mauved with --state-dir /var/lib/mauve");
  }
  const std::string path = word(state, "path");
  if (word(state, "exists") != "true")
    return bad("there is no " + path + ": nothing is saved", "mkdir --parents " + path);
  if (anybody_writes(whole_number(state, "mode"))) {
    return bad("everybody may write " + listed(state), "chmod o-w " + path);
  }
  if (word(facts.status, "saved") == "false") {
    return bad("the newest generation was not saved in " + listed(state) +
                   ": after a crash an older one would start",
               "mauvectl logs --level warn says why");
  }
  return good(listed(state));
}

Finding check_space(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  const Json state = facts.daemon.value("state_dir", Json());
  if (!state.is_object() || !state.contains("free_bytes")) return good("nothing is kept");
  const double free = number(state, "free_bytes");
  const std::string path = word(state, "path");
  const std::string found =
      size_of(free) + " of " + size_of(number(state, "total_bytes")) + " are free at " + path;
  const std::string remedy =
      "mv " + path + "/audit.log /var/tmp/; du --max-depth 1 --human-readable " + path;
  if (free < kFull) return bad(found, remedy);
  return free < kScarce ? doubt(found, remedy) : good(found);
}

}  // namespace mauve::ctl::doctor
