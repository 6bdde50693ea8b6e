// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/capsule.h>

#include <mauve/converts.h>

namespace mauve {

const ConvertsBase* Capsule::converter_from(const DataType& other) const {
  for (const ConvertsBase* known : converters_) {
    if (same_type(known->from(), other)) return known;
  }
  return nullptr;
}

}  // namespace mauve
