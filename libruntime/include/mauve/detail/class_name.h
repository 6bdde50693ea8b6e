// SPDX-License-Identifier: LGPL-3.0-or-later
/// The name of a class as its author wrote it, for contracts and types without a name of their own.
#pragma once

#include <string>
#include <typeinfo>

#include <mauve/host/version.h>

namespace mauve {

/// "guidance::ControlShell"; of a class in an unnamed namespace too. [any], not on a real-time
/// thread.
[[nodiscard]] std::string class_name(const std::type_info& type);

}  // namespace mauve
