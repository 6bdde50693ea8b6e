// SPDX-License-Identifier: LGPL-3.0-or-later
/// Its MAUVE_PLUGIN block throws.
#include <stdexcept>

#include <mauve/plugin.h>

MAUVE_PLUGIN(plugin) { throw std::runtime_error("cannot declare " + plugin.name()); }
