// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/observable.h>

#include <string>
#include <string_view>

#include "model/job/log_text.h"

namespace mauve {

ObservableBase::ObservableBase(Configurable& owner, std::string_view name, std::string_view text,
                               std::string_view unit, const DataType& type)
    : owner_(owner), name_(name), text_(text), unit_(unit), type_(&type) {
  owner.observables_.push_back(this);
}

std::string ObservableBase::address() const { return owner_.address() + "." + std::string(name_); }

Warning::Warning(Configurable& owner, std::string_view name, std::string_view text)
    : ObservableBase(owner, name, text, {}, data_type<bool>()) {}

void Warning::keep(const char* reason, const LogArgument& a, const LogArgument& b) {
  const auto keep_one = [](Argument& into, const LogArgument& from) {
    into.is_number.store(from.is_number, std::memory_order_relaxed);
    if (from.is_number) {
      into.number.store(from.number, std::memory_order_relaxed);
    } else {
      into.integer.store(from.integer, std::memory_order_relaxed);
    }
  };
  keep_one(a_, a);
  keep_one(b_, b);
  reason_.store(reason, std::memory_order_release);
}

std::string Warning::reason() const {
  const auto kept = [](const Argument& from) {
    return from.is_number.load(std::memory_order_relaxed)
               ? LogArgument(from.number.load(std::memory_order_relaxed))
               : LogArgument(from.integer.load(std::memory_order_relaxed));
  };
  const char* const reason = reason_.load(std::memory_order_acquire);
  return reason == nullptr ? std::string() : fill_in(reason, kept(a_), kept(b_));
}

Value Warning::value() const { return lasts(); }

bool Warning::change(bool now_lasts) {
  if (lasts() == now_lasts) return false;
  written_.store(job_time(), std::memory_order_relaxed);
  bits_.store(now_lasts ? 1 : 0, std::memory_order_release);
  return true;
}

}  // namespace mauve
