// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/component/wiring.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <mauve/detail/codec_scalar.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/host/ring_buffer.h>
#include <mauve/port.h>

namespace mauve {
namespace {

bool commands(const PortBase& port) {
  const PortKind kind = port.signature().kind;
  return kind == PortKind::write || kind == PortKind::call;
}

/// The text of a note about a port that is not connected; none where that is as it should be.
/// `left`: the service that it loses, which gets its safe value; null: none.
std::optional<std::string> without_connection(const PortBase& port, const ServiceBase* left) {
  switch (port.need()) {
    case Need::optional:
      return std::nullopt;
    case Need::required:
      return "is not connected, but its component expects a connection";
    case Need::usual:
      break;
  }
  if (port.signature().kind == PortKind::read)
    return "is not connected: each read returns the default of the port, and never data";
  if (!port.has_safe_value()) return std::nullopt;
  if (left != nullptr)
    return "loses its connection: the change writes its safe value into " + left->address() +
           ", and its later values reach nothing";
  return "is not connected: its values, and its safe value, reach nothing";
}

}  // namespace

Wiring::Wiring(const Architecture& architecture) {
  for (const ComponentBase* component : architecture.components()) {
    const auto bundle = component->bundle();
    put(component->name(), *bundle->shell, *bundle->bindings, false);
    devices_.put(component->name(), *bundle->shell, *bundle->core, false);
    tasks_[component->name()] = bundle->task;
  }
  for (const ResourceBase* resource : architecture.resources()) {
    put(resource->name(), resource->shell(), resource->bindings(), false);
  }
}

void Wiring::put(const std::string& name, const Shell& shell, const Bindings& bindings) {
  put(name, shell, bindings, true);
}

void Wiring::put(const std::string& name, const Bundle& bundle) {
  put(name, *bundle.shell, *bundle.bindings, true);
  devices_.put(name, *bundle.shell, *bundle.core, true);
  tasks_[name] = bundle.task;
}

void Wiring::remove(const std::string& name) {
  elements_.erase(name);
  devices_.remove(name);
  tasks_.erase(name);
}

void Wiring::put(const std::string& name, const Shell& shell, const Bindings& bindings,
                 bool is_new) {
  std::vector<Port>& ports = elements_[name];
  const std::vector<Port> before = std::exchange(ports, {});
  for (const PortBase* port : shell.ports()) {
    const auto index = port->index();
    const Binding* const binding = index < bindings.size() ? bindings[index].get() : nullptr;
    const ServiceBase* const service = binding == nullptr ? nullptr : &binding->service();
    ports.push_back({name + ".ports." + std::string(port->name()), port, service, is_new});
    const auto same = std::ranges::find(before, ports.back().address, &Port::address);
    if (service == nullptr && same != before.end()) ports.back().left = same->service;
  }
}

void Wiring::connect(const std::string& port, const ServiceBase* service) {
  for (auto& [name, ports] : elements_) {
    const auto found = std::ranges::find(ports, port, &Port::address);
    if (found != ports.end()) *found = {port, found->port, service, true};
  }
}

std::map<std::string, Wiring::Written> Wiring::written() const {
  std::map<std::string, Written> written;
  for (const auto& [name, ports] : elements_) {
    for (const Port& one : ports) {
      if (one.service == nullptr || !commands(*one.port)) continue;
      Written& into = written[one.service->address()];
      into.service = one.service;
      const auto place = std::ranges::find_if(into.by, [](const Port* p) { return p->is_new; });
      into.by.insert(one.is_new ? into.by.end() : place, &one);
    }
  }
  return written;
}

const Wiring::Port* Wiring::output_behind(const ResourceBase& resource) const {
  for (const auto& [name, ports] : elements_) {
    for (const Port& one : ports) {
      const bool reads = one.port->signature().kind == PortKind::read;
      const bool takes = reads && one.port->writers() == Writers::one;
      if (takes && one.service != nullptr && &one.service->resource() == &resource) return &one;
    }
  }
  return nullptr;
}

Status Wiring::check() const {
  std::vector<Error> all = errors();
  return all.empty() ? ok() : Status(std::move(all.front()));
}

std::vector<Error> Wiring::errors() const {
  std::vector<Error> errors;
  for (const auto& [address, one] : written()) {
    if (one.by.size() < 2) continue;
    const Port* const output = output_behind(one.service->resource());
    if (one.service->writers() != Writers::one && output == nullptr) continue;
    const std::string obeyed =
        output == nullptr ? "" : " (" + output->address + " obeys its values)";
    errors.push_back(
        refuse({Errc::conflict, "writer_is_exclusive"}, one.by.back()->address,
               "would be the second writer of " + address + obeyed + ": " +
                   one.by.front()->address + " writes into it, and only one port may",
               "disconnect one of the two in the same change, or let a resource choose between "
               "them (teleop/priority)"));
  }
  std::ranges::move(devices_.errors(), std::back_inserter(errors));
  return errors;
}

std::string Wiring::only_writer(const ServiceBase& service) const {
  const bool alone =
      service.writers() == Writers::one || output_behind(service.resource()) != nullptr;
  if (!alone) return {};
  const auto all = written();
  const auto found = all.find(service.address());
  return found == all.end() ? std::string() : found->second.by.front()->address;
}

std::vector<Wiring::Note> Wiring::notes() const {
  std::vector<Note> notes;
  for (const auto& [name, ports] : elements_) {
    for (const Port& one : ports) {
      if (one.service != nullptr) continue;
      if (auto text = without_connection(*one.port, one.left))
        notes.push_back({one.address, *std::move(text)});
    }
  }
  for (const auto& [address, one] : written()) {
    const bool keeps_all = dynamic_cast<const RingBufferBase*>(&one.service->resource()) != nullptr;
    if (one.by.size() < 2 || keeps_all || one.service->signature().kind != PortKind::write)
      continue;
    std::string names;
    for (const Port* port : one.by) names += (names.empty() ? "" : ", ") + port->address;
    notes.push_back({address, "has " + std::to_string(one.by.size()) +
                                  " writers, and the last value counts: " + names});
  }
  for (auto& [address, text] : devices_.notes()) {
    notes.push_back({std::move(address), std::move(text)});
  }
  for (const auto& [name, task] : tasks_) {
    if (task.watchdog == Duration{0} || task.watchdog >= task.budget) continue;
    notes.push_back(
        {name + ".task.watchdog", "is " + format_duration(task.watchdog) +
                                      ", below the budget of " + format_duration(task.budget) +
                                      ": it ends jobs within the budget, and takes them for hung"});
  }
  return notes;
}

std::string to_string(const Wiring::Note& note) { return note.address + " " + note.text; }

}  // namespace mauve
