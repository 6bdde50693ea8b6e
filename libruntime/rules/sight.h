// SPDX-License-Identifier: LGPL-3.0-or-later
/// Sight: whether a value that a rule looks at is known. Pure: time and value come in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mauve/host/value.h"
#include "mauve/result.h"
#include "mauve/time.h"

namespace mauve::rules {

/// True for a value that a condition can be judged by: it is there, and no NaN.
[[nodiscard]] bool is_known(const Result<Value>& value);

/// Decides when a change between known and unknown is reported. A value that was known is lost at
/// once. A value that was never known is lost after kSettled, so that a start reports nothing. A
/// lost value is known again after it was known for kSettled. So a value which comes and goes
/// reports at most two changes in that time. [control]
class Sight {
 public:
  static constexpr Duration kSettled{1s};

  /// Called at every look. True: lost() is another one than before.
  [[nodiscard]] bool step(Instant now, bool known);
  [[nodiscard]] bool lost() const { return lost_; }

 private:
  bool lost_ = false;
  bool was_known_ = false;
  std::optional<Instant> since_;  // the value contradicts lost_
};

/// A value that became unknown, or is known again.
struct SightChange {
  std::string address;
  Value value;  ///< null: there is none
  bool lost = false;
  std::vector<std::string> rules;  ///< that look at it
  Duration max_age{0};             ///< of these rules: null may be an older value
};

}  // namespace mauve::rules
