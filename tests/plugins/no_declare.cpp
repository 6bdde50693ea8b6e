// SPDX-License-Identifier: LGPL-3.0-or-later
/// A good manifest, but no function behind it.
#include <mauve/plugin.h>

extern "C" MAUVE_EXPORT __attribute__((section(".mauve.manifest")))
const mauve::PluginEntry mauve_plugin;
extern "C" MAUVE_EXPORT const mauve::PluginEntry mauve_plugin = {
    mauve::detail::make_manifest(MAUVE_PLUGIN_NAME, "1.0.0"), nullptr};
