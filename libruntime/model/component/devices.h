// SPDX-License-Identifier: LGPL-3.0-or-later
/// The devices that the cores of components open.
#pragma once

#include <map>
#include <string>

#include <mauve/result.h>

namespace mauve {

class CoreBase;

/// The devices of all components, as they are or as a change would leave them. A device is the text
/// of a property `device` of a core, for paths in /dev/ (Limits::within). A resource may share the
/// device of a component, as a brake does.
class Devices {
 public:
  /// The component has this core now. `is_new`: the core is asked for, and check() is about it if
  /// it names another device than the core before.
  void put(const std::string& component, const CoreBase& core, bool is_new);
  void remove(const std::string& component) { opened_.erase(component); }

  /// Refused with `conflict` when a device that is new is that of another component, under
  /// whichever path: of two drivers each overrules the other, or takes its bytes. Two old ones may
  /// have become one device since, which no change is to blame for. Looks into /dev/. [control] or
  /// [factory]
  [[nodiscard]] Status check() const;

 private:
  struct Opened {
    std::string address;  ///< of the property
    std::string path;
    bool is_new = false;
  };

  std::map<std::string, Opened> opened_;  // by component
};

}  // namespace mauve
