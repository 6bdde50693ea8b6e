// SPDX-License-Identifier: LGPL-3.0-or-later
/// The users whose files may become code of this process, or decide which programs it starts and
/// which users reach it.
#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <set>
#include <string>

#include "mauve/result.h"

namespace mauve::plugin {

/// Trusted are root, the user the process runs as, and all who can replace libmauve itself: they
/// need no plugin to run code here. Those are its owner, the owners of the directories above it,
/// and groups that may write there. So a developer's tree works under sudo, and an installed
/// runtime takes plugins from root only.
struct Trust {
  std::set<uid_t> owners;
  std::set<gid_t> groups;

  /// Of this process; found once. [factory]
  static const Trust& of_this_process();
  /// Of the owner `user` and of those who can replace `library`, an absolute path.
  static Trust of(uid_t user, const std::string& library);

  /// Refused: another owner, writable by an untrusted group or by everybody. A sticky directory may
  /// be writable (/tmp): each file in it is checked for itself.
  [[nodiscard]] Status check(const struct stat& status, const std::string& path) const;

  /// The same of `path`, which is absolute, and of each directory above it: a user who may write
  /// one of them chooses where the path leads. A symbolic link on the way counts by its owner, and
  /// is followed. A file or directory that does not exist yet is not judged, but the directories
  /// above it are. The error is at the file or directory that is to blame. [any but rt]
  [[nodiscard]] Status check_path(const std::string& path) const;
};

}  // namespace mauve::plugin
