// SPDX-License-Identifier: LGPL-3.0-or-later
/// A manifest with one fault, chosen by the build; the code behind it must never be called.
#include <cstdlib>

#include <mauve/plugin.h>

namespace {

void never(mauve::Plugin& /*plugin*/) { std::abort(); }

constexpr mauve::PluginManifest faulty() {
  mauve::PluginManifest manifest = mauve::detail::make_manifest(MAUVE_PLUGIN_NAME, "1.0.0");
#if defined(WRONG_MAGIC)
  manifest.magic[0] = 'X';
#elif defined(WRONG_ABI)
  manifest.abi += 1;
#elif defined(WRONG_SIZE)
  manifest.size += 8;
#elif defined(WRONG_FINGERPRINT)
  manifest.fingerprint ^= 1;
#endif
  return manifest;
}

}  // namespace

extern "C" MAUVE_EXPORT __attribute__((section(".mauve.manifest")))
const mauve::PluginEntry mauve_plugin;
extern "C" MAUVE_EXPORT const mauve::PluginEntry mauve_plugin = {faulty(), never};
