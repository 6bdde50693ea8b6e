// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rollbacks of this run: the changes that each one undid, its cause, and the user who asked
/// for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mauve::daemon {

/// The user who asked for an undo.
struct UndoRequest {
  std::uint32_t uid = 0;
  std::string reason;  ///< as given, may be empty
};

struct RollbackRecord {
  std::vector<std::uint64_t> undone;   ///< the generations that it took back, the oldest first
  std::vector<std::string> elements;   ///< that it changed
  std::uint64_t generation = 0;        ///< that it made
  std::string time;                    ///< UTC
  std::string cause;                   ///< "control threw: sensor lost", "undone by request"
  std::optional<UndoRequest> by = {};  ///< none: mauved made it by itself
};

/// [control] Remembers the newest kMost rollbacks.
class Rollbacks {
 public:
  static constexpr std::size_t kMost = 1024;

  /// The undo of the change that made this generation is under way. The first request counts.
  void ask(std::uint64_t generation, UndoRequest request);
  /// The user who asked for the undo of these changes; none: no user did. The request is forgotten.
  [[nodiscard]] std::optional<UndoRequest> take(const std::vector<std::uint64_t>& undone);

  void remember(RollbackRecord rollback);
  /// The rollback of the change that made this generation; null: not known.
  [[nodiscard]] const RollbackRecord* of(std::uint64_t generation) const;
  /// The newest one that changed this element; null: not known.
  [[nodiscard]] const RollbackRecord* last_of(std::string_view element) const;

 private:
  std::map<std::uint64_t, UndoRequest> requests_;  // by generation
  std::deque<RollbackRecord> rollbacks_;
};

}  // namespace mauve::daemon
