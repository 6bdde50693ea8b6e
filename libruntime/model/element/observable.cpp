// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/observable.h>

#include <string>
#include <string_view>

namespace mauve {

ObservableBase::ObservableBase(Configurable& owner, std::string_view name, std::string_view text,
                               std::string_view unit, const DataType& type)
    : owner_(owner), name_(name), text_(text), unit_(unit), type_(&type) {
  owner.observables_.push_back(this);
}

std::string ObservableBase::address() const { return owner_.address() + "." + std::string(name_); }

}  // namespace mauve
