// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/sight.h"

#include <cmath>

namespace mauve::rules {

bool is_known(const Result<Value>& value) {
  if (!value || value->is_null()) return false;
  const auto* number = value->get_if<double>();
  return number == nullptr || !std::isnan(*number);
}

bool Sight::step(Instant now, bool known) {
  const bool steady = lost_ == !known;
  was_known_ = was_known_ || known;
  if (steady) {
    since_.reset();
    return false;
  }
  if (!since_) since_ = now;
  const bool at_once = !known && was_known_;
  if (!at_once && Duration{now - *since_} < kSettled) return false;
  lost_ = !known;
  since_.reset();
  return true;
}

}  // namespace mauve::rules
