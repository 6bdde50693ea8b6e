// SPDX-License-Identifier: LGPL-3.0-or-later
/// The architecture that mauved must start next, from its answers alone. It is the rules of
/// daemon/README.md, "What is kept", written a second time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"
#include "support/temp_dir.h"

namespace mauve::test {

/// `either`: nothing was answered about it yet, so it may be confirmed by now or not.
enum class Worth : std::uint8_t { unconfirmed, confirmed, either };

/// A generation as the answers describe it.
struct Kept {
  using Json = protocol::Json;

  Json content;                      ///< as config.get exports it; null: not known
  Worth worth = Worth::unconfirmed;  ///< only a confirmed one is started after a crash
  bool saved = true;                 ///< was answered as saved; false: may be on the disk or not
};

class KeptOracle {
 public:
  using Json = protocol::Json;

  static constexpr std::size_t kKept = 100;

  /// A new generation; a number is never used again for another content.
  void add(std::uint64_t number, Kept kept) {
    const auto [there, fresh] = kept_.emplace(number, kept);
    EXPECT_TRUE(fresh || !there->second.saved || there->second.content == kept.content)
        << "generation " << number << " is used again for another content";
    if (kept.saved) highest_ = std::max(highest_, number);
    there->second = std::move(kept);
  }
  /// The run starts with this one, which is not confirmed before somebody says so.
  void begin(std::uint64_t number, const Json& content) {
    EXPECT_GT(number, highest_) << "numbers go on over restarts";
    add(number, {content, Worth::unconfirmed, true});
  }
  void set_worth(std::uint64_t number, Worth worth) {
    const auto found = kept_.find(number);
    if (found != kept_.end()) found->second.worth = worth;
  }
  /// A stop by a user was answered; until a user starts the component it stands.
  void stopped_by_user(const std::string& component) { users_.insert(component); }
  void started_by_user(const std::string& component) { users_.erase(component); }
  /// With the components stopped that a user has stopped.
  [[nodiscard]] Json with_stops(Json content) const {
    for (auto& [name, component] : content["components"].items()) {
      if (users_.contains(name)) component["start"] = false;
    }
    return content;
  }
  [[nodiscard]] const Kept* find(std::uint64_t number) const {
    const auto found = kept_.find(number);
    return found == kept_.end() ? nullptr : &found->second;
  }
  [[nodiscard]] const std::map<std::uint64_t, Kept>& all() const { return kept_; }

  /// Looks into the folder after a kill: what was answered as saved is there as it was answered,
  /// and what nothing was answered about is learnt. `ran_long`: what began in this run may be
  /// confirmed by its time.
  void compare(const std::filesystem::path& generations, bool ran_long) {
    for (auto it = kept_.begin(); it != kept_.end();) {
      const bool there = compare_one(generations, it->first, it->second, ran_long);
      if (there) highest_ = std::max(highest_, it->first);
      it = there ? std::next(it) : kept_.erase(it);
    }
    for (const auto& entry : std::filesystem::directory_iterator(generations)) {
      if (entry.path().extension() != ".json") continue;
      const auto number = std::stoull(entry.path().stem().string());
      EXPECT_TRUE(kept_.contains(number)) << "nobody made generation " << number;
    }
  }

  /// Somebody killed the run, which counts against nothing: this architecture is started next. The
  /// components that the newest generation or a user has stopped stay stopped, in an older one and
  /// in the file too.
  [[nodiscard]] Json after_kill(const Json& file) const {
    const Json newest = kept_.empty() ? Json::object() : kept_.rbegin()->second.content;
    for (auto it = kept_.rbegin(); it != kept_.rend(); ++it) {
      if (confirmed_(it->second)) return with_stops(stopped(it->second.content, newest));
    }
    return with_stops(stopped(file, newest));
  }
  /// The run came to its orderly end: the file is started next, and the stops of users stand.
  [[nodiscard]] Json after_end(const Json& file) const { return with_stops(file); }

 private:
  static bool confirmed_(const Kept& kept) { return kept.worth == Worth::confirmed; }

  /// With the components stopped that this newest generation has stopped.
  [[nodiscard]] static Json stopped(Json content, const Json& newest) {
    const auto of_newest = newest.value("components", Json::object());
    for (auto& [name, component] : content["components"].items()) {
      if (!of_newest.value(name, Json::object()).value("start", true)) component["start"] = false;
    }
    return content;
  }
  /// False: it is not there.
  bool compare_one(const std::filesystem::path& generations, std::uint64_t number, Kept& kept,
                   bool ran_long) const {
    auto on_disk = read(generations, number);
    if (!on_disk) {
      EXPECT_TRUE(!kept.saved || may_be_gone(number, kept, generations))
          << "generation " << number << " was answered as saved and is not there";
      return false;
    }
    auto& [mark, content] = *on_disk;
    EXPECT_TRUE(kept.content.is_null() || kept.content == content)
        << "generation " << number << " is saved as " << content << ", not " << kept.content;
    const bool confirmed = mark == "confirmed";
    const bool open = kept.worth == Worth::either || (ran_long && !confirmed_(kept));
    EXPECT_TRUE(open || confirmed == confirmed_(kept))
        << "generation " << number << " is marked " << mark;
    kept.content = std::move(content);
    kept.worth = confirmed ? Worth::confirmed : Worth::unconfirmed;
    kept.saved = true;
    return true;
  }
  /// A start that was never confirmed goes after a crash, a copy that a newer one replaces, and one
  /// that has as many newer ones as are kept.
  [[nodiscard]] bool may_be_gone(std::uint64_t number, const Kept& kept,
                                 const std::filesystem::path& generations) const {
    if (kept.worth != Worth::confirmed) return true;
    std::size_t newer = 0;
    bool replaced = false;
    for (auto it = kept_.upper_bound(number); it != kept_.end(); ++it) {
      const auto on_disk = read(generations, it->first);
      if (!on_disk) continue;
      ++newer;
      replaced = replaced || (on_disk->first == "confirmed" && on_disk->second == kept.content);
    }
    // A copy that was replaced, and a start that nobody confirmed, may have gone after it.
    constexpr std::size_t kGone = 2;
    return replaced || newer + kGone >= kKept;
  }
  /// Mark and content of the file of a generation.
  [[nodiscard]] static std::optional<std::pair<std::string, Json>> read(
      const std::filesystem::path& generations, std::uint64_t number) {
    auto name = std::to_string(number);
    name.insert(0, name.size() < 6 ? 6 - name.size() : 0, '0');
    const auto text = TempDir::read(generations / (name + ".json"));
    const auto brace = text.find('{');
    const auto end = text.find('\n');
    if (brace >= end || end == std::string::npos) return std::nullopt;
    const auto head = Json::parse(text.substr(brace, end - brace), nullptr, false);
    auto content = Json::parse(text.substr(end), nullptr, false);
    if (!head.is_object() || !content.is_object()) return std::nullopt;
    return std::pair(head.value("mark", ""), std::move(content));
  }

  std::map<std::uint64_t, Kept> kept_;
  std::uint64_t highest_ = 0;    ///< that was answered as saved, or is on the disk
  std::set<std::string> users_;  ///< what users have stopped
};

}  // namespace mauve::test
