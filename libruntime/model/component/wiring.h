// SPDX-License-Identifier: LGPL-3.0-or-later
/// All elements of a system together. Two ports may write into one output, and two components may
/// open one device. A port may lack a connection, and a watchdog may be below the budget.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/component/devices.h"

#include <mauve/detail/binding.h>
#include <mauve/host/task_attributes.h>
#include <mauve/result.h>

namespace mauve {

class Architecture;
struct Bundle;
class PortBase;
class ResourceBase;
class ServiceBase;
class Shell;

/// The connections as they are, or as a change would leave them. [control] or [factory], while no
/// element of the architecture comes or goes.
class Wiring {
 public:
  explicit Wiring(const Architecture& architecture);
  /// The element `name` has these connections, instead of those that it had.
  void put(const std::string& name, const Shell& shell, const Bindings& bindings);
  /// The component `name` has this bundle: its connections, its device and its task.
  void put(const std::string& name, const Bundle& bundle);
  /// The port of this address is connected to the service, or to none (null). An address that no
  /// port has changes nothing.
  void connect(const std::string& port, const ServiceBase* service);
  void remove(const std::string& name);

  /// Refused with `conflict` when two ports write into an output of which the author declares that
  /// one port at most may do so (Writers::one), and by Devices::errors(). The error names
  /// a port or a property of an element that put() brought, where it can.
  [[nodiscard]] Status check() const;
  /// All that check() may refuse. As check().
  [[nodiscard]] std::vector<Error> errors() const;

  /// The port that alone may write into this service, because the author declares so; empty: others
  /// may write too, or none does.
  [[nodiscard]] std::string only_writer(const ServiceBase& service) const;

  /// A sentence about a declaration that may be a mistake, and is none to the runtime.
  struct Note {
    std::string address;  ///< of a port, a service or an attribute of a task
    std::string text;     ///< "is not connected: its values, and its safe value, reach nothing"

    bool operator==(const Note&) const = default;
  };
  /// The notes concern ports without a connection: those that read or have a safe value, unless
  /// they are optional, and those that are required. They also concern services for one value at a
  /// time (not of ring buffers) into which several ports write, a watchdog below the budget, and
  /// two drivers of one device.
  [[nodiscard]] std::vector<Note> notes() const;

 private:
  struct Port {
    std::string address;
    const PortBase* port = nullptr;
    const ServiceBase* service = nullptr;  ///< null: not connected
    bool is_new = false;                   ///< brought by put()
    const ServiceBase* left = nullptr;     ///< that it loses by put(); null: none
  };
  struct Written {
    const ServiceBase* service = nullptr;
    std::vector<const Port*> by;  ///< those that put() brought last
  };

  /// The services that ports write into or call, by address.
  [[nodiscard]] std::map<std::string, Written> written() const;
  /// The read port of an exclusive output that obeys the values of this resource; null: none.
  [[nodiscard]] const Port* output_behind(const ResourceBase& resource) const;

  void put(const std::string& name, const Shell& shell, const Bindings& bindings, bool is_new);

  std::map<std::string, std::vector<Port>> elements_;
  std::map<std::string, TaskAttributes> tasks_;  // of components
  Devices devices_;
};

/// "control.ports.power is not connected: ..."
[[nodiscard]] std::string to_string(const Wiring::Note& note);

}  // namespace mauve
