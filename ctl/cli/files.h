// SPDX-License-Identifier: LGPL-3.0-or-later
/// Files that the user names; errors are reported in the words of the system.
#pragma once

#include <fstream>
#include <functional>
#include <ostream>
#include <string>

#include "mauve/result.h"

namespace mauve::ctl {

[[nodiscard]] Result<std::ifstream> open_to_read(const std::string& path);

/// The whole file.
Status write_file(const std::string& path, const std::function<void(std::ostream&)>& write);

/// The error of the file operation that just failed, by errno.
[[nodiscard]] Error not_written(const std::string& path);

}  // namespace mauve::ctl
