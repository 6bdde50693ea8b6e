// SPDX-License-Identifier: LGPL-3.0-or-later
// Locks and roles judge the differences that a change makes, never the method that asks for it.
#include "commands/lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mauve/host/architecture.h"
#include "mauve/host/change.h"
#include "unit/daemon/front.h"

namespace mauve::daemon {
namespace {

using server::Role;

struct Bare : Architecture {
  Bare() : Architecture("empty") {}
};

class LocksAndRoles : public Front<Bare> {
 protected:
  void TearDown() override {
    running.lock = Lock::none;
    Front::TearDown();
  }
};

TEST_F(LocksAndRoles, HoldEveryKindOfRequestButAStopAndAConfirmationUnderLockAll) {
  for (const auto lock : {Lock::none, Lock::params, Lock::topology, Lock::all}) {
    running.lock = lock;
    EXPECT_EQ(check_lock_of_all(running, Kind::other).has_value(), lock != Lock::all)
        << to_string(lock);
    for (const auto kind : {Kind::stop, Kind::ending, Kind::harmless, Kind::steps}) {
      EXPECT_TRUE(check_lock_of_all(running, kind))
          << to_string(lock) << " " << static_cast<int>(kind);
    }
  }
}

Call of_role(Role role) {
  Call call;
  call.caller.role = role;
  return call;
}

TEST_F(LocksAndRoles, HoldEveryDifferenceButAStopUnderLockAll) {
  running.lock = Lock::all;
  const auto stop = arch::make_line("start", "a.start", true, false);
  EXPECT_TRUE(may_change(running, of_role(Role::operator_), {stop}));
  for (const auto* kind : {"start", "property", "core", "plugin", "rules", "a kind of tomorrow"}) {
    const auto other = arch::make_line(kind, "a", false, true);
    EXPECT_FALSE(may_change(running, of_role(Role::admin), {stop, other})) << kind;
  }

  Change change;
  change.edits.emplace_back().mode = Mode::park;
  EXPECT_TRUE(check_lock_of_all(running, change));
  change.edits.emplace_back().mode = Mode::run;
  EXPECT_FALSE(check_lock_of_all(running, change));
  change.edits.back().mode = Mode::park;
  change.edits.back().properties.emplace_back("core.gain", 1.0);
  EXPECT_FALSE(check_lock_of_all(running, change)) << "it does more than to stop";
}

/// The lines of a change decide, whichever method makes it.
TEST_F(LocksAndRoles, JudgeAChangeByTheRoleThatItsDifferencesNeed) {
  const auto may = [&](Role role, const char* kind) {
    return may_change(running, of_role(role), {arch::make_line(kind, "a", 1, 2)}).has_value();
  };
  for (const auto* kind : {"core", "port", "property", "start", "task"}) {
    EXPECT_TRUE(may(Role::operator_, kind)) << kind;
    EXPECT_FALSE(may(Role::viewer, kind)) << kind;
  }
  for (const auto* kind : {"resource", "component", "fsm", "fallback_core", "lock_budget", "plugin",
                           "rules", "transactions", "may_request", "a kind of tomorrow"}) {
    EXPECT_TRUE(may(Role::admin, kind)) << kind;
    const auto refused =
        may_change(running, of_role(Role::operator_), {arch::make_line(kind, "a", 1, 2)});
    ASSERT_FALSE(refused) << kind;
    EXPECT_EQ(refused.error().code, Errc::not_permitted) << kind;
    EXPECT_THAT(refused.error().message, testing::HasSubstr("needs role admin")) << kind;
  }
}

/// A lock that a user has set, and the answer to a request of the user with the id 1000.
class LockOfAUser : public LocksAndRoles {
 protected:
  Json set(const std::string& lock, const std::string& reason = {}) {
    Json params = {{"lock", lock}};
    if (!reason.empty()) params["reason"] = reason;
    const auto outcome = ask(Role::admin, "lock.set", params);
    const auto* answer = std::get_if<Json>(&outcome);
    return answer == nullptr ? Json() : *answer;
  }
  void lock_as(uid_t uid) {
    running.lock = Lock::all;
    running.locked = {uid, "2026-01-31T12:00:00.000000Z", "survey of field 3"};
  }
};

TEST_F(LockOfAUser, IsUnchangedByTheSameLevelWithoutAnotherReason) {
  lock_as(1001);
  for (const auto* reason : {"", "survey of field 3"}) {
    const auto answer = set("all", reason);
    EXPECT_EQ(answer["changed"], false) << answer;
    EXPECT_EQ(answer["state"], "unchanged") << answer;
    EXPECT_FALSE(answer.contains("notes")) << answer;
    EXPECT_EQ(running.locked.uid, 1001U);
    EXPECT_EQ(running.locked.time, "2026-01-31T12:00:00.000000Z");
    EXPECT_EQ(running.locked.reason, "survey of field 3");
  }
}

TEST_F(LockOfAUser, NamesTheReasonThatANewOneReplaces) {
  lock_as(1000);

  const auto answer = set("all", "repair");

  EXPECT_EQ(answer["changed"], true) << answer;
  EXPECT_EQ(answer["notes"], Json({"the new reason replaces that of the lock all of uid 1000, set "
                                   "at 2026-01-31T12:00:00Z (survey of field 3)"}));
  EXPECT_EQ(running.locked.reason, "repair");
}

TEST_F(LockOfAUser, IsNamedByTheRequestThatEndsOrWeakensIt) {
  lock_as(1000);
  EXPECT_EQ(set("none")["notes"], Json({"this ends the lock all of uid 1000, set at "
                                        "2026-01-31T12:00:00Z (survey of field 3)"}));
  lock_as(1001);
  EXPECT_EQ(
      set("topology")["notes"],
      Json({"the lock topology replaces the lock all of another user, uid 1001, set at "
            "2026-01-31T12:00:00Z (survey of field 3), and permits changes that it refused"}));
  const auto stronger = set("all")["notes"][0].get<std::string>();
  EXPECT_THAT(stronger, testing::StartsWith("the lock all replaces the lock topology of uid 1000"));
  EXPECT_THAT(stronger, testing::Not(testing::HasSubstr("permits")));
}

TEST_F(LockOfAUser, OfNothingHasNoNoteAndNeverChanges) {
  const auto answer = set("none", "nothing to do");

  EXPECT_EQ(answer["changed"], false) << answer;
  EXPECT_FALSE(answer.contains("notes")) << answer;
  EXPECT_FALSE(set("params").contains("notes"));
}

/// An administrator's change of the elements is on probation; to undo it is such a change too.
TEST_F(LocksAndRoles, LetAnOperatorUndoNothingThatNeedsAnAdmin) {
  const std::string more = R"({"schema": "mauve/architecture/1", "name": "empty", "resources":
      {"more": {"type": "shared_data", "data": "double"}}})";
  ASSERT_TRUE(
      std::holds_alternative<Json>(ask(Role::admin, "architecture.apply", {{"text", more}})));

  const auto fault = refused(Role::operator_, "change.undo");

  EXPECT_EQ(fault.name, "not_permitted") << fault.message;
  EXPECT_EQ(fault.where, "more");
  EXPECT_EQ(fault.state, "unchanged");
}

TEST_F(LocksAndRoles, HoldTheLinesOfAChangeUnderLockParamsAndLockTopology) {
  const auto property = arch::make_line("property", "a.core.x", 1, 2);
  const auto core = arch::make_line("core", "a.core", "old", "new");
  const auto start = arch::make_line("start", "a.start", false, true);
  const auto fallback = [](double gain) {
    return Value(Value::Object{{"core", "old"}, {"properties", Value::Object{{"x", gain}}}});
  };
  const auto standby =
      arch::make_line("fallback_core", "a.fallback_core", fallback(1), fallback(2));
  const auto held = [&](Lock lock, const arch::Line& line) {
    running.lock = lock;
    return !may_change(running, of_role(Role::admin), std::vector{start, line});
  };

  EXPECT_TRUE(held(Lock::params, property));
  EXPECT_TRUE(held(Lock::params, standby)) << "the value of a fallback core is a property too";
  EXPECT_FALSE(held(Lock::params, core));
  EXPECT_TRUE(held(Lock::topology, core));
  EXPECT_FALSE(held(Lock::topology, property));
  EXPECT_FALSE(held(Lock::topology, start));
  EXPECT_FALSE(held(Lock::none, core));
  EXPECT_FALSE(held(Lock::none, property));
}

}  // namespace
}  // namespace mauve::daemon
