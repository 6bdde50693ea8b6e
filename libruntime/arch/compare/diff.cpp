// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/diff.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "arch/parse/built_in.h"
#include "arch/parse/parts.h"
#include "mauve/host/architecture.h"
#include "model/element/state_transfer.h"

namespace mauve::arch {
namespace {

const Bindings& bindings_of(const ComponentBase& component) {
  return *component.bundle()->bindings;
}
const Bindings& bindings_of(const ResourceBase& resource) { return resource.bindings(); }

template <typename Element>
const Binding* connection_of(const Element& element, std::string_view port) {
  const PortBase* const found = element.shell().find_port(port);
  const Bindings& bindings = bindings_of(element);
  const bool connected = found != nullptr && found->index() < bindings.size();
  return connected ? bindings[found->index()].get() : nullptr;
}

NewConnection connection_to(const Binding& binding, std::string_view port) {
  return {std::string(port), binding.service().address(), binding.max_age()};
}

/// The connections of an element that is not in force; it loses them.
template <typename Element>
std::vector<NewConnection> take_connections(Element& element) {
  std::vector<NewConnection> removed;
  for (const PortBase* port : element.shell().ports()) {
    const Binding* const binding = connection_of(element, port->name());
    if (binding != nullptr) removed.push_back(connection_to(*binding, port->name()));
  }
  for (const NewConnection& connection : removed) {
    static_cast<void>(element.disconnect(connection.port));
  }
  return removed;
}

bool same_properties(const Configurable& a, const Configurable& b) {
  return std::all_of(a.properties().begin(), a.properties().end(), [&](const PropertyBase* one) {
    const PropertyBase* const other = b.find_property(one->name());
    return other != nullptr && same_value(one->value(), other->value());
  });
}

/// Can the one become the other while it runs?
bool same_element(const ComponentBase& a, const ComponentBase& b) {
  return title_of(a) == title_of(b);
}
bool same_element(const ResourceBase& a, const ResourceBase& b) {
  return title_of(a) == title_of(b) && same_properties(a.shell(), b.shell()) &&
         same_properties(a.interface(), b.interface());
}

Edit edit_of(const std::string& name) {
  Edit edit;
  edit.member = name;
  return edit;
}

bool says_nothing(const Edit& edit) {
  return !edit.core && !edit.fsm && !edit.task && !edit.lock_budget && edit.properties.empty() &&
         edit.connect.empty() && edit.disconnect.empty() && edit.mode == Mode::keep;
}

/// One comparison of two architectures.
class Differ {
 public:
  Differ(const Architecture& running, Architecture& wanted, const Parked& parked)
      : running_(running), wanted_(wanted), parked_(parked) {}

  Difference run() {
    say("architecture", "name", running_.name(), wanted_.name());
    for (const ResourceBase* now : running_.resources()) {
      const ResourceBase* const then = wanted_.find_resource(now->name());
      if (then != nullptr && !same_element(*now, *then)) replaced_.insert(now->name());
    }
    for (const ResourceBase* then : wanted_.resources()) {
      visit("resource", running_.find_resource(then->name()), *then);
    }
    for (const ResourceBase* now : running_.resources()) {
      if (wanted_.find_resource(now->name()) == nullptr) leaves("resource", *now);
    }
    for (const ComponentBase* then : wanted_.components()) {
      visit("component", running_.find_component(then->name()), *then);
    }
    for (const ComponentBase* now : running_.components()) {
      if (wanted_.find_component(now->name()) == nullptr) leaves("component", *now);
    }
    for (const std::string& name : replaced_) {
      const ResourceBase& now = *running_.find_resource(name);
      const CoreBase& core = now.core();
      const bool has_state =
          core.declared_state() != nullptr || core.declared_slow_state() != nullptr;
      const auto values =
          plan_transfer(now, *wanted_.find_resource(name), StatePolicy::keep, false);
      if (has_state || (values && values->from != nullptr) || used_.contains(name))
        difference_.exchanged.push_back(name);
    }
    take_out();
    return std::move(difference_);
  }

 private:
  /// Adds a line, unless both values are the same or both are null.
  void say(std::string kind, std::string address, Value before, Value after) {
    if (same_value(before, after)) return;
    difference_.lines.push_back(
        make_line(std::move(kind), std::move(address), std::move(before), std::move(after)));
  }

  template <typename Element>
  void visit(const char* kind, const Element* now, const Element& then) {
    if (now != nullptr && same_element(*now, then)) return change(*now, then);
    joining_.insert(then.name());
    if (now == nullptr) return say(kind, then.name(), {}, title_of(then));
    difference_.change.remove.push_back(now->name());
    say(kind, now->name(), title_of(*now), title_of(then));
    Edit unused = edit_of(now->name());
    if (title_of(*now) == title_of(then)) return properties_and_ports(*now, then, true, unused);
    values_of_another_type(*now, then);
  }

  /// A property with the same name and type in both has its own line when its value differs.
  template <typename Element>
  void values_of_another_type(const Element& now, const Element& then) {
    const Parts before = parts_of(now);
    const Parts after = parts_of(then);
    for (std::size_t i = 0; i < after.size(); ++i) {
      for (const PropertyBase* property : after[i].second->properties()) {
        const PropertyBase* const old = before[i].second->find_property(property->name());
        if (old == nullptr || !same_type(old->type(), property->type())) continue;
        say("property",
            now.name() + "." + std::string(after[i].first) + "." + std::string(property->name()),
            old->value(), property->value());
      }
    }
  }

  template <typename Element>
  void leaves(const char* kind, const Element& now) {
    difference_.change.remove.push_back(now.name());
    say(kind, now.name(), title_of(now), {});
  }

  /// Runs last: until then the other elements are connected to those that join. The elements that
  /// stay in `wanted` lose their connections too, or they would hold services that are in force.
  void take_out() {
    const std::vector<ComponentBase*> components = wanted_.components();
    const std::vector<ResourceBase*> resources = wanted_.resources();
    for (ResourceBase* resource : resources) {
      auto connections = take_connections(*resource);
      if (!joining_.contains(resource->name())) continue;
      difference_.change.new_resources.push_back(
          {wanted_.take_out(*resource), std::move(connections)});
    }
    for (ComponentBase* component : components) {
      auto connections = take_connections(*component);
      if (!joining_.contains(component->name())) continue;
      difference_.change.new_components.push_back(
          {wanted_.take_out(*component), std::move(connections)});
    }
  }

  void change(const ResourceBase& now, const ResourceBase& then) {
    Edit edit = edit_of(now.name());
    properties_and_ports(now, then, true, edit);
    hold(now, then, edit);
    if (!says_nothing(edit)) difference_.change.edits.push_back(std::move(edit));
  }

  void hold(const ResourceBase& now, const ResourceBase& then, Edit& edit) {
    if (now.lock().budget() == then.lock().budget()) return;
    edit.lock_budget = then.lock().budget();
    say("lock_budget", now.name() + ".lock_budget", describe_lock_budget(now),
        describe_lock_budget(then));
  }

  void change(const ComponentBase& now, const ComponentBase& then) {
    const Bundle& before = *now.bundle();
    const Bundle& after = *then.bundle();
    Edit edit = edit_of(now.name());
    say("core", now.name() + ".core", before.core_type.name, after.core_type.name);
    say("fsm", now.name() + ".fsm", before.fsm_type.name, after.fsm_type.name);
    const bool same_core = before.core_type.name == after.core_type.name;
    if (!same_core) edit.core = after.core_type;
    edit.values = Values::defaults;  // a property that the file leaves out has its default
    if (before.fsm_type.name != after.fsm_type.name) edit.fsm = after.fsm_type;
    fallback(now, then, edit);
    properties_and_ports(now, then, same_core, edit);
    task(now, then, edit);
    mode(now, then, edit);
    if (!says_nothing(edit)) difference_.change.edits.push_back(std::move(edit));
  }

  /// `same_core`: a core made anew begins with the values of the one before.
  template <typename Element>
  void properties_and_ports(const Element& now, const Element& then, bool same_core, Edit& edit) {
    const Parts before = parts_of(now);
    const Parts after = parts_of(then);
    for (std::size_t i = 0; i < after.size(); ++i) {
      const auto& [group, part] = after[i];
      const bool copied = group != "core" || same_core;
      for (const PropertyBase* property : part->properties()) {
        compare(group, before[i].second->find_property(property->name()), *property, copied, edit);
      }
    }
    for (const PortBase* port : then.shell().ports()) {
      compare(port->name(), connection_of(now, port->name()), connection_of(then, port->name()),
              edit);
    }
  }

  void compare(std::string_view group, const PropertyBase* now, const PropertyBase& then,
               bool copied, Edit& edit) {
    const Value after = then.value();
    if (after.is_null()) return;  // its type has no description: no file can set it
    const bool known = now != nullptr && same_type(now->type(), then.type());
    const Value before = known ? now->value() : then.default_value();
    const Value first = copied ? before : then.default_value();
    const std::string name = std::string(group) + "." + std::string(then.name());
    if (!same_value(first, after)) edit.properties.emplace_back(name, after);
    if (same_value(before, after)) return;
    say("property", edit.member + "." + name, known ? before : Value(), after);
  }

  void compare(std::string_view port, const Binding* now, const Binding* then, Edit& edit) {
    const Value before = describe_connection(now);
    const Value after = describe_connection(then);
    const bool lost = now != nullptr && replaced_.contains(now->service().resource().name());
    if (lost) used_.insert(now->service().resource().name());
    if (same_value(before, after) && !lost) return;
    if (now != nullptr) edit.disconnect.emplace_back(port);
    if (then != nullptr) edit.connect.push_back(connection_to(*then, port));
    say("port", edit.member + ".ports." + std::string(port), before, after);
  }

  void task(const ComponentBase& now, const ComponentBase& then, Edit& edit) {
    const auto before = describe_task(now.task());
    const auto after = describe_task(then.task());
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (same_value(before[i].second, after[i].second)) continue;
      edit.task = then.task();
      say("task", now.name() + ".task." + std::string(after[i].first), before[i].second,
          after[i].second);
    }
  }

  void mode(const ComponentBase& now, const ComponentBase& then, Edit& edit) {
    const bool runs = parked_ ? !parked_(now) : now.task().start;
    if (runs == then.task().start) return;
    edit.mode = runs ? Mode::park : Mode::run;
    say("start", now.name() + ".start", runs, !runs);
  }

  void fallback(const ComponentBase& now, const ComponentBase& then, Edit& edit) {
    const Value before = describe_fallback(now.fallback());
    const Value after = describe_fallback(then.fallback());
    if (same_value(before, after)) return;
    edit.task = then.task();  // the component takes part, so that there is a generation for it
    difference_.change.fallbacks.push_back({now.name(), then.fallback()});
    say("fallback_core", now.name() + ".fallback_core", before, after);
  }

  const Architecture& running_;
  Architecture& wanted_;
  const Parked& parked_;
  std::set<std::string, std::less<>> replaced_;  // resources at which no connection can stay
  std::set<std::string, std::less<>> used_;      // those of them that are connected to others
  std::set<std::string, std::less<>> joining_;
  Difference difference_;
};

bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool is_integer(const Value& value) { return kind_of(value) == "an integer"; }

}  // namespace

std::string title_of(const ComponentBase& component) { return component.type().name; }

std::string title_of(const ResourceBase& resource) {
  const std::string& type = resource.type().name;
  return is_built_in(type) ? type + " " + resource.find_service("read")->signature().types : type;
}

std::string_view to_string(Line::Op op) {
  switch (op) {
    case Line::Op::add:
      return "add";
    case Line::Op::remove:
      return "remove";
    case Line::Op::change:
      return "change";
  }
  return "unknown";
}

Line make_line(std::string kind, std::string address, Value before, Value after) {
  Line::Op op = Line::Op::change;
  if (before.is_null()) op = Line::Op::add;
  if (after.is_null()) op = Line::Op::remove;
  return {op, std::move(kind), std::move(address), std::move(before), std::move(after)};
}

Difference compare(const Architecture& running, Architecture& wanted, const Parked& parked) {
  return Differ(running, wanted, parked).run();
}

bool same_value(const Value& a, const Value& b) {
  if (a == b) return true;
  if (is_integer(a) && is_integer(b)) return false;
  const auto number_a = a.number();
  const auto number_b = b.number();
  if (number_a && number_b) return same_number(*number_a, *number_b);
  const auto* items_a = a.get_if<Value::Array>();
  const auto* items_b = b.get_if<Value::Array>();
  if (items_a != nullptr && items_b != nullptr) {
    return std::equal(items_a->begin(), items_a->end(), items_b->begin(), items_b->end(),
                      same_value);
  }
  const auto* members_a = a.get_if<Value::Object>();
  const auto* members_b = b.get_if<Value::Object>();
  return members_a != nullptr && members_b != nullptr && members_a->size() == members_b->size() &&
         std::all_of(members_a->begin(), members_a->end(), [&](const auto& one) {
           const Value* other = b.find(one.first);
           return other != nullptr && same_value(one.second, *other);
         });
}

}  // namespace mauve::arch
