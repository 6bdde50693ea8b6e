// SPDX-License-Identifier: LGPL-3.0-or-later
/// Crowd: more clients of one mauved than it takes of one user. They belong to several users of a
/// group "mauve-view" that only this mauved sees.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/process.h"
#include "support/raw_client.h"

namespace mauve::test {

class Crowd {
 public:
  static constexpr std::size_t kOfOneUser = 8;
  static constexpr const char* kNotPossible =
      "needs root and the right to mount, for clients of four users";

  [[nodiscard]] static bool possible() {
    return geteuid() == 0 && Process({"/usr/bin/unshare", "--mount", "/usr/bin/mount", "--bind",
                                      "/etc/group", "/etc/group"})
                                     .wait() == 0;
  }

  /// Every user who keeps the group of this process is a viewer.
  [[nodiscard]] static std::string viewers() {
    return "mauve-view:x:" + std::to_string(getegid()) + ":\n";
  }

  /// Writes two files into `place`; mauved sees `known` as the groups of the machine.
  Crowd(const std::filesystem::path& place, const std::string& mauved,
        const std::string& known = viewers())
      : program_(place / "mauved_with_viewers") {
    const auto groups = place / "group";
    std::ofstream(groups) << known;
    std::ofstream(program_) << "#!/bin/sh\nexec /usr/bin/unshare --mount /bin/sh -c '"
                            << "/usr/bin/mount --bind " << groups.string() << " /etc/group && "
                            << "exec \"$0\" \"$@\"' " << mauved << " \"$@\"\n";
    std::filesystem::permissions(program_, std::filesystem::perms::owner_all);
  }

  /// Takes the arguments of mauved, and becomes it.
  [[nodiscard]] std::string program() const { return program_.string(); }

  /// The client of this number, which has read its greeting. Not while other threads run.
  [[nodiscard]] static RawClient client(const std::filesystem::path& socket, std::size_t number) {
    using std::filesystem::perms;
    std::filesystem::permissions(socket.parent_path(), perms::owner_all | perms::group_exec);
    const uid_t user = kFirstUser + static_cast<uid_t>(number / kOfOneUser);
    const bool became = seteuid(user) == 0;  // keeps the group
    RawClient client(socket);
    if (became && seteuid(0) != 0) std::abort();
    static_cast<void>(client.json());
    return client;
  }

 private:
  static constexpr uid_t kFirstUser = 50'001;

  std::filesystem::path program_;
};

}  // namespace mauve::test
