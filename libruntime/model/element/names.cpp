// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/element/names.h"

#include <map>
#include <string>
#include <string_view>

#include "base/address.h"

#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/interface.h>
#include <mauve/observable.h>
#include <mauve/property.h>
#include <mauve/service.h>
#include <mauve/shell.h>

namespace mauve {
namespace {

/// Names that stand at the same place of an address, each with the kind of the thing that it names.
class NameSpace {
 public:
  explicit NameSpace(const std::string& element) : element_(element) {}

  template <typename Things>
  Status add(const Things& things, std::string_view noun) {
    for (const auto* thing : things) {
      if (Status done = add_one(thing->name(), noun); !done) return done;
    }
    return ok();
  }

 private:
  Status add_one(std::string_view name, std::string_view noun) {
    if (Status legal = check_name(name, element_); !legal) {
      legal.error().message = std::string(noun) + " " + legal.error().message;
      return legal;
    }
    const auto [known, is_new] = nouns_.emplace(name, noun);
    if (is_new) return ok();
    // Only a property and an observable share a name space.
    const std::string which = known->second == noun ? "more than one " + std::string(noun)
                                                    : "a property and of an observable";
    return refuse({Errc::duplicate, "address_not_unique"}, element_,
                  "\"" + std::string(name) + "\" is the name of " + which,
                  "rename one of them in the plugin: an address leads to one thing only");
  }

  const std::string& element_;
  std::map<std::string_view, std::string_view> nouns_;
};

}  // namespace

Status check_names(const Configurable& element) {
  NameSpace names(element.address());
  Status done = names.add(element.properties(), "property");
  if (done) done = names.add(element.observables(), "observable");
  return done;
}

Status check_names(const Shell& shell) {
  const Configurable& values = shell;
  if (Status done = check_names(values); !done) return done;
  return NameSpace(shell.address()).add(shell.ports(), "port");
}

Status check_names(const FsmBase& fsm) {
  const Configurable& values = fsm;
  if (Status done = NameSpace(fsm.address()).add(fsm.states(), "state"); !done) return done;
  return check_names(values);
}

Status check_names(const InterfaceBase& interface) {
  const Configurable& values = interface;
  if (Status done = check_names(values); !done) return done;
  return NameSpace(interface.address()).add(interface.services(), "service");
}

}  // namespace mauve
