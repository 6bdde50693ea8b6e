// SPDX-License-Identifier: LGPL-3.0-or-later
/// The answer to a reload has two parts. The receipt is in the books as soon as the new code is in
/// force, before anything else can happen to it. The fate of the old code is known later. The
/// answer goes out when both are there.
#pragma once

#include <optional>

#include "base/mutex.h"
#include "plugin/load/library.h"
#include "server/dispatcher.h"

namespace mauve::daemon {

class ReloadAnswer {
 public:
  explicit ReloadAnswer(server::Reply reply) : reply_(std::move(reply)) {}

  void receipt(server::Outcome outcome);     ///< [any]
  void old_code(plugin::Unmapped unmapped);  ///< [any]

 private:
  void reply_when_whole() MAUVE_REQUIRES(mutex_);

  Mutex mutex_;
  server::Reply reply_ MAUVE_GUARDED_BY(mutex_);
  std::optional<server::Outcome> outcome_ MAUVE_GUARDED_BY(mutex_);
  std::optional<plugin::Unmapped> unmapped_ MAUVE_GUARDED_BY(mutex_);
};

}  // namespace mauve::daemon
