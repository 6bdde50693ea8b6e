// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/service.h>

#include <mauve/host/resource.h>
#include <mauve/interface.h>

namespace mauve {

ServiceBase::ServiceBase(InterfaceBase& owner, std::string_view name, Signature signature,
                         Writers writers)
    : owner_(owner), name_(name), signature_(std::move(signature)), writers_(writers) {
  owner.services_.push_back(this);
}

ResourceBase& ServiceBase::resource() const { return owner_.resource(); }
CoreBase& ServiceBase::core() const { return owner_.core(); }
ResourceLock& ServiceBase::lock() const { return owner_.resource().lock(); }
std::string ServiceBase::address() const { return resource().name() + "." + std::string(name_); }

}  // namespace mauve
