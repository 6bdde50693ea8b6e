// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/service.h>

#include "model/find_named.h"

#include <mauve/interface.h>
#include <mauve/resource.h>

namespace mauve {

ServiceBase::ServiceBase(InterfaceBase& owner, std::string_view name, Signature signature,
                         Writers writers)
    : owner_(owner), name_(name), signature_(std::move(signature)), writers_(writers) {
  owner.services_.push_back(this);
}

ResourceBase& ServiceBase::resource() const { return owner_.resource(); }
CoreBase& ServiceBase::core() const { return owner_.core(); }
Gate& ServiceBase::gate() const { return owner_.resource().gate(); }
std::string ServiceBase::address() const { return resource().name() + "." + std::string(name_); }

ServiceBase* InterfaceBase::find_service(std::string_view name) const {
  return find_named(services_, name);
}

std::string_view to_string(DataStatus status) {
  switch (status) {
    case DataStatus::no_data:
      return "no_data";
    case DataStatus::old_data:
      return "old_data";
    case DataStatus::new_data:
      return "new_data";
    case DataStatus::stale:
      return "stale";
    case DataStatus::timed_out:
      return "timed_out";
    case DataStatus::poisoned:
      return "poisoned";
  }
  return "unknown";
}

std::string_view to_string(PortKind kind) {
  switch (kind) {
    case PortKind::read:
      return "read";
    case PortKind::write:
      return "write";
    case PortKind::call:
      return "call";
    case PortKind::event:
      return "event";
  }
  return "unknown";
}

std::string to_string(const Signature& signature) {
  return std::string(to_string(signature.kind)) + " " + signature.types;
}

}  // namespace mauve
