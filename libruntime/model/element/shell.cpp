// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/shell.h>

#include <string_view>

#include "model/element/find_named.h"

#include <mauve/detail/port_base.h>

namespace mauve {

PortBase* Shell::find_port(std::string_view name) const { return find_named(ports_, name); }

}  // namespace mauve
