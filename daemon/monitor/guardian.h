// SPDX-License-Identifier: LGPL-3.0-or-later
/// The guardian as mauved sees it: a process that puts outputs into their safe state when mauved
/// ends without notice, or falls silent (guardian/README.md).
#pragma once

#include "commands/command.h"
#include "options.h"
#include "rt/guardian/guardian_link.h"

namespace mauve::daemon {

class Guardian {
 public:
  explicit Guardian(logging::Log& log) : log_(log) {}

  /// Before elements are made: their configure hooks name the outputs that are to be guarded.
  /// [main]
  Status start(const Options& options);
  /// From now on all components are stopped after a silence that the guardian took for an end, and
  /// when a guardian that is required is lost. [main]
  void serve(Running& running);
  /// In order: all components stand with their safe values, so that the guardian lets go. [main]
  void stop(bool in_order) { link_.stop(in_order); }
  /// Of `status`: which guardian holds which outputs, or why none does. [any]
  [[nodiscard]] Json json() const;

 private:
  void report(const rt::GuardianNews& news);
  void stop_all();

  logging::Log& log_;
  std::atomic<Running*> running_{nullptr};
  rt::GuardianUse use_ = rt::GuardianUse::prefer;
  std::atomic<const char*> cause_{nullptr};  // of a stop that is still to be made
  rt::GuardianLink link_;
};

}  // namespace mauve::daemon
