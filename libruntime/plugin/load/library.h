// SPDX-License-Identifier: LGPL-3.0-or-later
/// A plugin in memory: its code, its declarations, and its users.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "mauve/detail/plugin_entry.h"
#include "mauve/result.h"
#include "plugin/elf/image.h"
#include "plugin/load/plugin_file.h"
#include "rt/thread/user_threads.h"

namespace mauve::plugin {

struct Facts;

/// Facts about a plugin that messages and answers show.
struct PluginInfo {
  std::string name;
  std::string version;
  std::string compiler;
  std::string build_id;               ///< hexadecimal, empty when the linker wrote none
  std::string file;                   ///< where it was loaded from; empty: compiled in
  std::size_t serial = 0;             ///< rises with every load in this process
  std::vector<std::string> warnings;  ///< things that are allowed but will hurt
};

/// Did the code of a plugin really leave the address space?
struct Unmapped {
  bool unmapped = false;
  std::string reason;       ///< why not, and its users; empty when it did
  bool types_only = false;  ///< true: not, since resources or ports use its data types
};

/// Mapped from construction to destruction. Everything made by the plugin holds it (hold.h), so no
/// order of destruction can run code that is gone. The last reference is dropped on [factory].
class Library {
 public:
  /// Checks and maps a plugin and calls its `declare`. [factory]
  static Result<std::shared_ptr<Library>> open(const PluginFile& file);
  /// A plugin that is part of the program. [any]
  static std::shared_ptr<Library> compiled_in(Plugin plugin);

  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library();

  [[nodiscard]] const PluginInfo& info() const { return info_; }
  /// As the plugin wrote it. Only hold.cpp may call its makers.
  [[nodiscard]] const Plugin& declared() const { return *declared_; }

  /// The addresses of elements, states and data types that still need the code. [any but rt]
  [[nodiscard]] std::vector<std::string> users() const;

  /// From now on nothing new is made from it: a newer version took its names. [control]
  void retire() { retired_.store(true, std::memory_order_release); }
  /// It has its names again: the newer version was rolled back. [control]
  void use_again() { retired_.store(false, std::memory_order_release); }
  [[nodiscard]] bool retired() const { return retired_.load(std::memory_order_acquire); }

  /// Drops this reference and returns whether the code is unmapped. Code whose threads still run
  /// stays mapped for the life of the process. Null: nothing was mapped. [factory]
  static Unmapped release(std::shared_ptr<Library> library);

 private:
  friend class Hold;
  struct User {
    std::string address;  // of an element that was adopted
    std::string name;     // of its type, or the whole text
  };
  using Users = std::list<User>;

  Library() = default;
  Status map(const Facts& facts, const std::string& name);
  Status declare(const PluginManifest& checked);

  PluginInfo info_;
  Image image_;
  void* handle_ = nullptr;
  rt::CodeRange code_;
  std::unique_ptr<Plugin> declared_;  // destroyed before the code is unmapped
  std::atomic<bool> retired_{false};
  mutable Mutex mutex_;  // of users_; never acquired by a real-time thread
  Users users_ MAUVE_GUARDED_BY(mutex_);
};

}  // namespace mauve::plugin
