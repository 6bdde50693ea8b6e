// SPDX-License-Identifier: LGPL-3.0-or-later
/// The symbol that a plugin exports, and the manifest that the loader reads from its file.
#pragma once

#include <cstdint>

#include <mauve/host/version.h>

namespace mauve {

class Plugin;

/// The first bytes of a plugin that the loader reads, from the file, before any of its code runs.
/// Fixed layout for all times; only `reserved` may be used up.
struct PluginManifest {
  char magic[8] = {'M', 'A', 'U', 'V', 'E', 'P', 'L', 'G'};
  std::uint32_t size = sizeof(PluginManifest);
  std::uint32_t abi = kAbi;
  std::uint64_t fingerprint = 0;  ///< of compiler, standard library and public classes
  char name[64] = {};
  char version[32] = {};
  char compiler[64] = {};
  std::uint64_t checksum = 0;  ///< of the mapped bytes, written after linking; 0: not yet
  std::uint64_t options = 0;   ///< bits of build_option
  std::uint64_t reserved[6] = {};
};

/// Build options that change the shape of classes beside headers and compiler. Values are fixed for
/// all times.
namespace build_option {
inline constexpr std::uint64_t kNewStrings = 1;        ///< _GLIBCXX_USE_CXX11_ABI=1
inline constexpr std::uint64_t kDebugContainers = 2;   ///< _GLIBCXX_DEBUG
inline constexpr std::uint64_t kAddressSanitizer = 4;  ///< -fsanitize=address
inline constexpr std::uint64_t kThreadSanitizer = 8;   ///< -fsanitize=thread
}  // namespace build_option

/// The one exported symbol of a plugin, `mauve_plugin`. The manifest comes first.
struct PluginEntry {
  PluginManifest manifest;
  void (*declare)(Plugin& plugin) = nullptr;
};

namespace detail {

constexpr std::uint64_t build_options() {
  std::uint64_t options = 0;
#if defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
  options |= build_option::kNewStrings;
#endif
#if defined(_GLIBCXX_DEBUG)
  options |= build_option::kDebugContainers;
#endif
#if defined(__SANITIZE_ADDRESS__)
  options |= build_option::kAddressSanitizer;
#endif
#if defined(__SANITIZE_THREAD__)
  options |= build_option::kThreadSanitizer;
#endif
  return options;
}

}  // namespace detail
}  // namespace mauve
