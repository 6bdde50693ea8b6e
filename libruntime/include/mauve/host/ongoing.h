// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes and stops that are under way.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <mauve/host/receipt.h>
#include <mauve/result.h>

namespace mauve {

class Retired;

/// A change, or a stop, that is under way: it is over when every member has come to its boundary.
/// [control]
class Ongoing {
 public:
  virtual ~Ongoing() = default;
  /// Looks how far it is and takes the next step; never waits. True when there is an answer; that
  /// comes in bounded time, if advance() is called now and then.
  virtual bool advance() = 0;
  /// The answer. The system may make a later generation than that of this change by itself, by a
  /// rollback or a fallback core. Such a generation enters the architecture when result() was
  /// asked, or when this object is not referred to any more, so that each generation can be looked
  /// at.
  [[nodiscard]] virtual Result<Receipt> result() const = 0;
  /// The generation that it has made, also one that ends with an error; 0: none, or none yet.
  [[nodiscard]] std::uint64_t made() const { return made_; }
  /// Elements that are no longer in force.
  virtual Retired& retired() = 0;

 protected:
  std::uint64_t made_ = 0;  ///< see made()
};

/// A stop that goes on without [control]. Used by one thread, which is no component's; destroyed
/// before the deployer.
class DirectStop {
 public:
  virtual ~DirectStop() = default;
  /// Looks how far it is and takes the next step; never waits. True when it is over, in bounded
  /// time.
  virtual bool advance() = 0;
  /// Components that ran when it began, and those of them that run still.
  [[nodiscard]] virtual const std::vector<std::string>& ran() const = 0;
  [[nodiscard]] virtual const std::vector<std::string>& run_still() const = 0;  ///< see ran()
};

}  // namespace mauve
