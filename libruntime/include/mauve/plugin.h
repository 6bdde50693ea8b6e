// SPDX-License-Identifier: LGPL-3.0-or-later
/// The header that a plugin author includes: all types of elements, and MAUVE_PLUGIN.
///
///   MAUVE_PLUGIN(plugin) { plugin.core<PotentialField>("potential_field"); }
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <mauve/detail/element_type.h>
#include <mauve/detail/plugin_entry.h>
#include <mauve/element.h>
#include <mauve/host/version.h>

#if defined(__GNUC__)
/// Keeps the one symbol of a plugin visible.
#define MAUVE_EXPORT __attribute__((visibility("default")))
#else
#define MAUVE_EXPORT
#endif

namespace mauve {

/// The names and types that a plugin offers, filled by its MAUVE_PLUGIN block when it is loaded.
/// Names are completed with the plugin's own: core "potential_field" of plugin "guidance" is
/// "guidance/potential_field". A name that occurs twice, and a default core of another contract,
/// refuse the plugin. [factory]
///
///   MAUVE_PLUGIN(plugin) {
///     plugin.type<Velocity>();
///     plugin.core<PotentialField>("potential_field");
///     plugin.component<ControlShell, ControlFsm>("control", "potential_field");
///   }
class Plugin {
 public:
  /// Of the loader, or of a program that has plugins linked in.
  explicit Plugin(std::string name, std::uint64_t build = 0)
      : name_(std::move(name)), build_(build) {}

  [[nodiscard]] const std::string& name() const { return name_; }  ///< of the file, without .so
  /// The checksum of its file; 0: it is part of the program.
  [[nodiscard]] std::uint64_t build() const { return build_; }

  /// A core; its contract is `T::Contract`, or T itself.
  template <typename T>
  void core(std::string_view name) {
    if constexpr (detail::check_core<T>()) cores.push_back(CoreType::of<T>(qualified(name)));
  }
  /// A state machine.
  template <typename T>
  void fsm(std::string_view name) {
    if constexpr (detail::check_fsm<T>()) fsms.push_back(FsmType::of<T>(qualified(name)));
  }
  /// A kind of component whose core is named in the file, or is `default_core` (a core of this
  /// plugin, or "other/core").
  template <typename ShellT, typename FsmT>
  void component(std::string_view name, std::string_view default_core = {}) {
    if constexpr (detail::check_parts<ShellT, FsmT>()) {
      components.push_back({qualified(name), ShellType::of<ShellT>(),
                            FsmType::of<FsmT>(qualified(name)),
                            default_core.empty() ? std::string() : qualified(default_core)});
    }
  }
  /// A kind of component with one core, registered under the same name.
  template <typename ShellT, typename CoreT, typename FsmT>
  void component(std::string_view name) {
    if constexpr (detail::check_parts<ShellT, CoreT, FsmT>()) {
      core<CoreT>(name);
      component<ShellT, FsmT>(name, name);
    }
  }
  /// A kind of resource.
  template <typename ShellT, typename CoreT, typename InterfaceT>
  void resource(std::string_view name) {
    if constexpr (detail::check_resource<ShellT, CoreT, InterfaceT>()) {
      resources.push_back({qualified(name), ShellType::of<ShellT>(),
                           CoreType::of<CoreT>(qualified(name)),
                           detail::make<InterfaceBase, InterfaceT>});
    }
  }
  /// A described data type.
  template <typename T>
  void type() {
    static_assert(detail::HasFields<T>,
                  "mauve: a type of a plugin is described: it has a static `type_name` and "
                  "`fields()`, as mauve/type.h shows");
    if constexpr (detail::HasFields<T>) types.push_back(&data_type<T>());
  }

  std::vector<CoreType> cores;            ///< as they were registered
  std::vector<FsmType> fsms;              ///< too
  std::vector<ComponentType> components;  ///< too
  std::vector<ResourceType> resources;    ///< too
  std::vector<const DataType*> types;     ///< too

 private:
  [[nodiscard]] std::string qualified(std::string_view name) const {
    return name.find('/') == std::string_view::npos ? name_ + "/" + std::string(name)
                                                    : std::string(name);
  }

  std::string name_;
  std::uint64_t build_;
};

namespace detail {

/// Changes when two translation units disagree about the shape of the public classes.
constexpr std::uint64_t abi_fingerprint() {
  std::uint64_t h = hash(static_cast<std::uint64_t>(kAbi), kHashSeed);
  for (const std::size_t size :
       {sizeof(Configurable), sizeof(PropertyBase), sizeof(ObservableBase), sizeof(Shell),
        sizeof(PortBase),     sizeof(CoreBase),     sizeof(StateBase),      sizeof(SlowStateBase),
        sizeof(ConvertsBase), sizeof(FsmBase),      sizeof(FsmState),       sizeof(InterfaceBase),
        sizeof(ServiceBase),  sizeof(Binding),      sizeof(Cursor),         sizeof(Exchange),
        sizeof(LatestValue),  sizeof(TapList),      sizeof(ResourceLock),   sizeof(Job),
        sizeof(Plugin),       sizeof(DataType),     sizeof(std::string),    sizeof(void*),
        sizeof(CoreType),     sizeof(FsmType),      sizeof(ComponentType),  sizeof(ResourceType)}) {
    h = hash(static_cast<std::uint64_t>(size), h);
  }
  return hash(build_options(), h);
}

template <std::size_t N>
constexpr void copy_text(char (&into)[N], const char* text) {
  for (std::size_t i = 0; i + 1 < N && text[i] != '\0'; ++i) into[i] = text[i];
}

constexpr PluginManifest make_manifest(const char* name, const char* version) {
  PluginManifest manifest;
  manifest.fingerprint = abi_fingerprint();
  manifest.options = build_options();
  copy_text(manifest.name, name);
  copy_text(manifest.version, version);
#if defined(__VERSION__)
  copy_text(manifest.compiler, __VERSION__);
#endif
  return manifest;
}

}  // namespace detail
}  // namespace mauve

#ifndef MAUVE_PLUGIN_NAME
/// Set by mauve_add_plugin() of CMake.
#define MAUVE_PLUGIN_NAME "unnamed"
#endif
#ifndef MAUVE_PLUGIN_VERSION
/// Set by mauve_add_plugin() of CMake.
#define MAUVE_PLUGIN_VERSION "0"
#endif

/// Once per plugin: `MAUVE_PLUGIN(plugin) { plugin.core<MyCore>("my_core"); }`
#define MAUVE_PLUGIN(parameter)                                                              \
  static void mauve_declare(::mauve::Plugin& parameter);                                     \
  static void mauve_begin(::mauve::Plugin& plugin) {                                         \
    ::mauve::detail::this_build = plugin.build();                                            \
    mauve_declare(plugin);                                                                   \
  }                                                                                          \
  extern "C" MAUVE_EXPORT __attribute__((section(".mauve.manifest")))                        \
  const ::mauve::PluginEntry mauve_plugin;                                                   \
  extern "C" MAUVE_EXPORT const ::mauve::PluginEntry mauve_plugin = {                        \
      ::mauve::detail::make_manifest(MAUVE_PLUGIN_NAME, MAUVE_PLUGIN_VERSION), mauve_begin}; \
  static void mauve_declare(::mauve::Plugin& parameter)
