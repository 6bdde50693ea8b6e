// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/job/log_text.h"

#include <mauve/host/value.h>

namespace mauve {

std::string fill_in(std::string literal, const LogArgument& a, const LogArgument& b) {
  std::size_t from = 0;
  for (const LogArgument* argument : {&a, &b}) {
    const auto hole = literal.find("{}", from);
    if (hole == std::string::npos) break;
    const std::string value = argument->is_number ? to_string(Value(argument->number))
                                                  : std::to_string(argument->integer);
    literal.replace(hole, 2, value);
    from = hole + value.size();
  }
  return literal;
}

}  // namespace mauve
