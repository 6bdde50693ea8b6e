// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/job/keep_for_abandoned.h"

#include <vector>

#include "base/mutex.h"

namespace mauve {

void keep_for_abandoned(std::shared_ptr<const void> object) {
  static Mutex mutex;
  // Never destroyed: threads may run into their objects while the process ends.
  static auto* const objects = new std::vector<std::shared_ptr<const void>>;
  const MutexLock lock(mutex);
  objects->push_back(std::move(object));
}

}  // namespace mauve
