// SPDX-License-Identifier: LGPL-3.0-or-later
/// plugin.reload with `in_place`: the component stops, its core lets go of its device, and the core
/// of the new build takes over. The new file is loaded while the component still runs.
#include "commands/change/reload/reload_in_place.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "commands/answer.h"
#include "commands/change/change_in_place.h"
#include "commands/change/change_request.h"
#include "commands/change/plugin_members.h"
#include "commands/model.h"
#include "commands/recovery/former.h"
#include "commands/recovery/quarantine.h"
#include "commands/say.h"

namespace mauve::daemon {

namespace {

/// The new build of the plugin. Its names are in force from the instant of the change on.
class NewBuild final : public ChangeHooks {
 public:
  NewBuild(Running& running, std::string plugin) : running_(running), plugin_(std::move(plugin)) {}

  /// [factory]
  Result<PreparedChange> prepare(Change& change) {
    loaded_ = running_.catalog.prepare_load(plugin_);
    if (!*loaded_) {
      return loaded_->error();
    }
    if (auto found = take_new_types(**loaded_, change); !found) {
      return found.error();
    }
    return running_.deployer.prepare_in_place(change.edits.front(), change.made_from);
  }

  Status check_prepared(PreparedChange& change) override {
    if (auto good = running_.catalog.check_types(**loaded_); !good) {
      return good;
    }
    if (auto kept = running_.catalog.check_types_in_use(**loaded_); !kept) {
      return kept;
    }
    lines_ = {line_of_build(running_, **loaded_)};
    std::ranges::move(lines_of(running_, change), std::back_inserter(lines_));
    notes_ = notes_on_lost_names(running_, change);
    return ok();
  }

  [[nodiscard]] std::optional<std::vector<arch::Line>> lines() const override { return lines_; }

  void in_force(std::uint64_t generation) override {
    auto former = running_.catalog.exchange(std::move(**loaded_));
    if (!former) {
      why_ = "the new code runs, and the names of the plugin stay with the older build: " +
             to_string(former.error());
    } else if (*former && is_place_on_probation(generation)) {
      keep_former(running_, generation, **std::move(former));
      why_ = "it is kept until the probation of generation " + std::to_string(generation) + " ends";
    } else if (*former) {
      let_go(running_, (*former)->library(), "replaced by a new one");
      why_ = "it leaves the memory when no thread looks at it any more, and the log says so";
    }
  }

  void complete(Json& result) override {
    result["plugin"] = plugin_;
    result["loaded"] = true;
    result["unmapped"] = false;
    result["why"] = why_;
    say_same_build(lines_, result);
    say_notes(notes_, result);
  }

 private:
  [[nodiscard]] bool is_place_on_probation(std::uint64_t generation) const {
    return std::ranges::find(running_.places, generation, &PlaceProbation::generation) !=
           running_.places.end();
  }

  Running& running_;
  std::string plugin_;
  std::optional<Result<plugin::LoadedPlugin>> loaded_;
  std::vector<arch::Line> lines_;
  std::vector<std::string> notes_;
  std::string why_;
};

}  // namespace

void reload_in_place(Running& running, const CallPtr& call, Ticket ticket,
                     const std::string& plugin, Change change) {
  auto build = std::make_shared<NewBuild>(running, plugin);
  apply_in_place(running, call, std::move(ticket), std::move(change), build,
                 [build](Change& wanted) { return build->prepare(wanted); });
}

}  // namespace mauve::daemon
