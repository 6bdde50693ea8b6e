// SPDX-License-Identifier: LGPL-3.0-or-later
/// The devices that the cores of components open.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <mauve/result.h>

namespace mauve {

class CoreBase;
class PropertyBase;
class Shell;

/// The property of the core that names its device: the first one for paths in /dev/
/// (Limits::within). Null: none does.
[[nodiscard]] const PropertyBase* device_of(const CoreBase& core);

/// The devices of all components, as they are or as a change would leave them. A device is the text
/// of a property of a core or a shell for paths in /dev/; each may have several. A resource may
/// share the device of a component, as a brake does.
class Devices {
 public:
  /// The component has this shell and this core now. `is_new`: they are asked for, and errors() is
  /// about them if they name another device than those before.
  void put(const std::string& component, const Shell& shell, const CoreBase& core, bool is_new);
  void remove(const std::string& component);

  /// A refusal with `conflict` for each device that is new and is that of another component, under
  /// whichever path: of two drivers each overrules the other, or takes its bytes. Two old ones may
  /// have become one device since, which no change is to blame for: see notes(). Looks into /dev/.
  /// [control] or [factory]
  [[nodiscard]] std::vector<Error> errors() const;
  /// The address of each device, old or new, that is that of a component before, with a sentence.
  /// As errors().
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> notes() const;

 private:
  struct Opened {
    std::string component;
    std::string path;
    bool is_new = false;
  };

  std::map<std::string, Opened> opened_;  // by the address of the property
};

}  // namespace mauve
