// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/update/prefetch_set.h"

#include <algorithm>

#include <mauve/detail/exchange.h>
#include <mauve/detail/port_base.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>
#include <mauve/shell.h>

namespace mauve::exec {
namespace {

constexpr std::uintptr_t kLine = 64;
/// So many bytes of an object whose class is not known: its most used members are there.
constexpr std::size_t kHead = 512;
/// So many bytes of a value: the CPU itself prefetches the rest of a longer one.
constexpr std::size_t kBegin = 1024;
/// So many lines at most: to ask for them takes the time of some hundred instructions.
constexpr std::size_t kAtMost = 256;

template <typename T>
const void* last_line_of(const T& object) {
  return reinterpret_cast<const std::byte*>(&object + 1) - kLine;
}

}  // namespace

PrefetchSet::PrefetchSet(const Bundle& bundle) {
  add(bundle.core.get(), kHead);
  add(*bundle.shell, *bundle.bindings);
  std::sort(lines_.begin(), lines_.end());
  lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
  if (lines_.size() > kAtMost) lines_.resize(kAtMost);
}

void PrefetchSet::add(const Shell& shell, const Bindings& bindings) {
  add(&shell, sizeof shell);
  add(bindings.data(), bindings.size() * sizeof bindings[0]);
  for (const PortBase* port : shell.ports()) {
    const Binding* const binding = bindings[port->index()].get();
    if (binding == nullptr) continue;
    const ServiceBase& service = binding->service();
    const ResourceBase& resource = service.resource();
    add(port, sizeof *port + kLine);
    add(binding, sizeof *binding);
    add(&service, kLine);
    add(*reinterpret_cast<const void* const*>(&service), 2 * kLine);  // NOLINT: its functions
    add(&resource.lock(), sizeof(ResourceLock));
    add(last_line_of(resource.interface()), kLine);  // its core and its resource
    if (binding->exchange() != nullptr) {
      add(*binding->exchange());
    } else {
      add(&resource.core(), kHead);
    }
  }
}

void PrefetchSet::add(const Exchange& exchange) {
  add(&exchange, sizeof exchange);
  for (const std::byte* slot : exchange.latest.first_slots()) {
    add(slot, std::min(exchange.latest.slot_size(), kBegin));
    add(slot + exchange.latest.size(), 1);
  }
}

void PrefetchSet::add(const void* object, std::size_t size) {
  const auto begin = reinterpret_cast<std::uintptr_t>(object);  // NOLINT: an address
  for (std::uintptr_t line = begin / kLine * kLine; line < begin + size; line += kLine) {
    lines_.push_back(line);
  }
}

}  // namespace mauve::exec
