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

Warning::Warning(Configurable& owner, std::string_view name, std::string_view text)
    : ObservableBase(owner, name, text, {}, data_type<bool>()) {}

std::string_view Warning::reason() const {
  const char* const reason = reason_.load(std::memory_order_relaxed);
  return reason == nullptr ? std::string_view{} : std::string_view(reason);
}

Value Warning::value() const { return lasts(); }

bool Warning::change(bool now_lasts) {
  if (lasts() == now_lasts) return false;
  bits_.store(now_lasts ? 1 : 0, std::memory_order_relaxed);
  written_.store(job_time(), std::memory_order_relaxed);
  return true;
}

}  // namespace mauve
