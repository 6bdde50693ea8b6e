// SPDX-License-Identifier: LGPL-3.0-or-later
/// Flight recordings: files flight-NNNN-WHY-COMPONENT.mtrace in the state directory. The oldest go
/// when there are too many, and those of missed releases first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "log/log.h"
#include "mauve/result.h"
#include "trace/memory.h"

namespace mauve::daemon {

struct Flight {
  std::uint64_t number = 0;
  std::string name;  ///< of the file, without its extension
  std::string why;
  std::string time;  ///< UTC
  std::size_t records = 0;
};

class Flights {
 public:
  static constexpr std::size_t kKept = 20;
  static constexpr std::size_t kKeptOfMisses = 5;  ///< while there are more than kKept

  /// Finds those of earlier runs. Waits for the disk. [main]
  Flights(std::string directory, logging::Log& log);

  /// Waits for the disk. A write that fails is reported once, until it works again. [disk]
  void write(const Recording& recording, const std::string& word, const std::string& component,
             const std::string& boot);
  /// The oldest first. [any]
  [[nodiscard]] std::vector<Flight> list() const;
  /// Where this one is; refused when there is none of this name. [any]
  [[nodiscard]] Result<std::filesystem::path> find(const std::string& name) const;

 private:
  void drop_oldest();
  [[nodiscard]] std::vector<Flight>::iterator least_wanted() MAUVE_REQUIRES(mutex_);

  const std::filesystem::path directory_;
  logging::Log& log_;
  bool broken_ = false;  ///< [disk]
  mutable Mutex mutex_;
  std::vector<Flight> flights_ MAUVE_GUARDED_BY(mutex_);
  std::uint64_t next_ MAUVE_GUARDED_BY(mutex_) = 1;
};

}  // namespace mauve::daemon
