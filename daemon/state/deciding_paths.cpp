// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/deciding_paths.h"

#include <sys/stat.h>

#include <filesystem>
#include <string_view>
#include <system_error>

#include "plugin/load/trust.h"
#include "protocol/socket_path.h"

namespace mauve::daemon {

namespace {

constexpr std::string_view kState = "state directory";
constexpr std::string_view kSocket = "socket directory";

std::string folder_of_service() {
  return std::filesystem::path(protocol::kServiceSocket).parent_path().string();
}

std::string whole(const std::string& path) {
  std::error_code failed;
  auto absolute = std::filesystem::absolute(path, failed);
  return failed ? path : absolute.string();
}

/// Files of a sticky directory are judged one by one, but another user may listen there first.
Status check_only_owner_writes(const std::string& folder) {
  struct stat its {};
  if (stat(folder.c_str(), &its) != 0 || (its.st_mode & S_IWOTH) == 0) {
    return ok();
  }
  return refuse({Errc::plugin_refused, "path_writable_by_others"}, folder,
                "may be written by everybody, so another user may listen there in place of mauved "
                "or its guardian",
                protocol::kUseOwnSocket);
}

/// How the file or directory that is to blame belongs to the path.
std::string relation(const std::string& blamed, const DecidingPath& deciding) {
  if (blamed == deciding.path) {
    return "it is the " + deciding.what;
  }
  const bool above = blamed == "/" || deciding.path.starts_with(blamed + "/");
  return (above ? "it holds the " : "it belongs to the ") + deciding.what + " " + deciding.path;
}

}  // namespace

std::vector<DecidingPath> deciding_paths(const Options& options) {
  std::vector<DecidingPath> paths{
      {"architecture file", whole(options.architecture)},
      {std::string(kSocket), std::filesystem::path(whole(options.socket)).parent_path().string()}};
  if (!options.state_dir.empty()) {
    paths.push_back({std::string(kState), whole(options.state_dir)});
  }
  return paths;
}

std::optional<Error> distrust_of(const DecidingPath& deciding) {
  // The deepest path is checked, because another user may put a directory of his own into a sticky
  // directory beforehand.
  const std::string deepest =
      deciding.what == kState ? deciding.path + "/generations" : deciding.path;
  Status trusted = plugin::Trust::of_this_process().check_path(deepest);
  if (trusted && deciding.what == kSocket) {
    trusted = check_only_owner_writes(deciding.path);
  }
  if (trusted) {
    return std::nullopt;
  }
  Error error = trusted.error();
  error.code = Errc::not_permitted;
  error.id = "path_not_trusted";
  const bool taken = deciding.what == kSocket && trusted.error().id == "path_owned_by_other";
  if (taken) {
    error.hint = protocol::kUseOwnSocket;
  }
  const bool services = deciding.path == folder_of_service() && error.at == deciding.path;
  error.message += " (" + relation(error.at, deciding) + (services ? " of the service)" : ")");
  return error;
}

Status check_trust(const std::vector<DecidingPath>& paths, Realtime realtime, logging::Log& log) {
  for (const auto& deciding : paths) {
    auto distrust = distrust_of(deciding);
    if (!distrust) {
      continue;
    }
    if (realtime == Realtime::require) {
      distrust->hint += (distrust->hint.empty() ? "" : "; ") +
                        std::string("--realtime prefer starts with a warning instead");
      return *std::move(distrust);
    }
    log.write(logging::Event::path_distrusted,
              {{"text", to_string(*distrust)}, {"file", distrust->at}});
  }
  return ok();
}

}  // namespace mauve::daemon
