// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/guarded.h>

#include "rt/guardian/guarded_outputs.h"

namespace mauve {

Status Guarded::hold(int descriptor, const SafeOrder& order) {
  const std::string name = owner_.address() + "." + std::string(name_);
  Status held = rt::GuardedOutputs::of_process().hold({this, &owner_, name}, descriptor, order);
  if (!held) {
    Error error = held.error();
    error.at = name;
    return error;
  }
  return held;
}

void Guarded::drop() { rt::GuardedOutputs::of_process().drop(this); }

}  // namespace mauve
