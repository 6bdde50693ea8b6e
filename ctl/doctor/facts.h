// SPDX-License-Identifier: LGPL-3.0-or-later
/// All that the checks look at: the files of the machine below a root, and the answers of mauved.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/message.h"

namespace mauve::ctl::doctor {

using protocol::Json;

struct Facts {
  std::filesystem::path root = "/";  ///< of /proc, /sys, /dev and /boot; another one in tests
  std::string socket;                ///< where mauved was asked, also below the root
  std::string client;                ///< version of mauvectl
  std::string glibc;                 ///< that mauvectl runs with
  std::string group = "mauve";       ///< for which a limit of logins is proposed
  Json daemon = nullptr;             ///< its answers to daemon.doctor, status.get and version
  Json status = nullptr;
  Json version = nullptr;
  std::string no_daemon;  ///< why those are null
  std::string hint;       ///< the remedy

  /// A file without the white space at its end; nothing when it cannot be read.
  [[nodiscard]] std::optional<std::string> text(std::string_view file) const;
  /// The names in a folder, sorted.
  [[nodiscard]] std::vector<std::string> names(std::string_view folder) const;
  /// The folders of CPUs, in their order: "cpu0", "cpu1".
  [[nodiscard]] std::vector<std::string> cpu_folders() const;
  /// "6.1.0-18-amd64", or nothing.
  [[nodiscard]] std::string kernel() const;
  /// The value of an option of the kernel's configuration, "y"; nothing where that is not kept.
  [[nodiscard]] std::optional<std::string> kernel_option(std::string_view name) const;
  /// A word of the kernel's command line: the value of "name=value", "" of a bare "name".
  [[nodiscard]] std::optional<std::string> boot_option(std::string_view name) const;
  /// The rows of components that asked for real-time threads.
  [[nodiscard]] std::vector<Json> components() const;
  /// The option --realtime with which mauved was started; empty without a mauved.
  [[nodiscard]] std::string asked_realtime() const;
};

/// The group of mauve that the caller is in: mauve or mauve-admin; mauve where it is in neither.
[[nodiscard]] std::string group_of_caller();

/// The number at the beginning of a text, -1 where there is none.
[[nodiscard]] std::int64_t whole(std::string_view text);

/// "0-2,5" is {0, 1, 2, 5}, and back.
[[nodiscard]] std::vector<int> cpus_in(std::string_view list);
[[nodiscard]] std::string cpu_list(const std::vector<int>& cpus);

}  // namespace mauve::ctl::doctor
