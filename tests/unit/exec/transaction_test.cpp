// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes of several elements as one: components and resources join, leave and change together, on
/// a clock that is moved by hand.
#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"

#include <mauve/detail/job.h>

namespace mauve {
namespace {

/// Reads `position` and counts what it saw.
struct ReaderShell : Shell {
  ReadPort<double> in{*this, "in", -100.0};
};
struct Reader : Core<ReaderShell> {
  Stateless stateless{*this};
  void update() {
    last() = shell().in.read();
    if (++jobs() == 1) first() = this_job().release;
  }
  /// The release of the first job.
  static Instant& first() {
    static Instant release = 0;
    return release;
  }
  static double& last() {
    static double value = 0;
    return value;
  }
  static int& jobs() {
    static int count = 0;
    return count;
  }
};
using ReaderComponent = Component<ReaderShell, Reader, PeriodicFsm<Reader>>;

class Transactions : public testing::Test {
 protected:
  void SetUp() override {
    Reader::last() = 0;
    Reader::jobs() = 0;
    ASSERT_TRUE(deployer.deploy());
  }

  /// A reader that no architecture knows yet.
  static std::shared_ptr<ComponentBase> reader(const std::string& name) {
    return std::make_shared<ComponentBase>(
        name,
        ComponentType{"reader", ShellType::of<ReaderShell>(),
                      FsmType::of<PeriodicFsm<Reader>>("reader"), "reader"},
        CoreType::of<Reader>("reader"));
  }
  static std::shared_ptr<ResourceBase> data(const std::string& name) {
    return std::make_shared<SharedDataBase>(name, data_type<double>());
  }
  /// Of the ramp, and says of its task what is so already.
  Edit with_its_task() {
    Edit edit;
    edit.member = "control";
    edit.task = architecture.control.bundle()->task;
    return edit;
  }
  Result<Receipt> apply(const Change& change) {
    Result<PreparedChange> prepared = deployer.prepare(change);
    if (!prepared) return prepared.error();
    return deployer.commit(*prepared, retired);
  }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
  Retired retired;
};

TEST_F(Transactions, LetAComponentJoinOnTheCommonGrid) {
  deployer.run_for(95ms);
  Change change;
  change.new_components.push_back({reader("reader"), {{"in", "position.read", 0ms}}});

  const Result<Receipt> done = apply(change);
  ASSERT_TRUE(done) << to_string(done.error());
  deployer.run_for(100ms);

  EXPECT_EQ(done->generation, 2u);
  EXPECT_EQ(deployer.status("reader").state, ComponentState::running);
  EXPECT_EQ(deployer.status("reader").next_release.count() % 10'000'000, 0);
  EXPECT_EQ(deployer.status("reader").releases, static_cast<std::uint64_t>(Reader::jobs()));
  EXPECT_GE(Reader::jobs(), 9);
  EXPECT_GT(Reader::last(), 0.0);
  EXPECT_EQ(deployer.status("control").missed, 0u);
}

TEST_F(Transactions, LetAComponentThatJoinsRunNothingBeforeTheInstant) {
  deployer.run_for(95ms);
  Change change;
  change.new_components.push_back({reader("reader"), {{"in", "position.read", 0ms}}});
  Result<PreparedChange> prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared) << to_string(prepared.error());

  const std::shared_ptr<Ongoing> ongoing = deployer.begin(*prepared);
  deployer.run_for(1us);
  EXPECT_EQ(Reader::jobs(), 0) << "nothing has happened yet";
  const Result<Receipt> done = deployer.wait(*ongoing);
  ASSERT_TRUE(done) << to_string(done.error());
  deployer.run_for(100ms);

  EXPECT_GE(Reader::first(), deployer.t0() + done->commit.count());
  EXPECT_EQ(deployer.status("reader").missed, 0u);
  ASSERT_FALSE(done->components.empty());
  EXPECT_EQ(done->components[0].missed, 0u);
  EXPECT_EQ(deployer.status("reader").lateness_max, 0ns);
}

TEST_F(Transactions, LetAComponentLeaveWithItsSafeValueWritten) {
  deployer.run_for(50ms);
  Change change;
  change.remove = {"control"};

  const Result<Receipt> done = apply(change);
  deployer.run_for(50ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(architecture.find_component("control"), nullptr);
  EXPECT_TRUE(deployer.status().empty());
  EXPECT_EQ(ramp::read(architecture.position), -1.0);
}

TEST_F(Transactions, ExchangeAResourceUnderAllItsUsersAtOnce) {
  Change first;
  first.new_components.push_back({reader("reader"), {{"in", "position.read", 0ms}}});
  ASSERT_TRUE(apply(first));
  Change change;
  change.new_resources.push_back({data("other"), {}});
  Edit writer;
  writer.member = "control";
  writer.disconnect = {"out"};
  writer.connect = {{"out", "other.write", 0ms}};
  Edit reading;
  reading.member = "reader";
  reading.disconnect = {"in"};
  reading.connect = {{"in", "other.read", 0ms}};
  change.edits = {writer, reading};
  change.remove = {"speed"};

  const Result<Receipt> done = apply(change);
  ASSERT_TRUE(done) << to_string(done.error());
  deployer.run_for(100ms);

  EXPECT_EQ(ramp::read(architecture.position), -1.0)
      << "the safe value of the port that moved away";
  EXPECT_GT(Reader::last(), 1.0);
  EXPECT_EQ(architecture.find_resource("speed"), nullptr);
  ASSERT_NE(architecture.find_resource("other"), nullptr);
}

TEST_F(Transactions, RefuseToRemoveAResourceThatIsInUse) {
  Change change;
  change.remove = {"position"};

  const Result<Receipt> refused = apply(change);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.ports.out");
  EXPECT_EQ(refused.error().message,
            "is connected to position.write, which is to be removed or made anew");
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_NE(architecture.find_resource("position"), nullptr);
}

TEST_F(Transactions, RefuseWhatIsEmptyOrSaidTwice) {
  Change twice;
  twice.edits.resize(2);
  twice.edits[0].member = twice.edits[1].member = "control";
  Change gone;
  gone.edits.resize(1);
  gone.edits[0].member = "control";
  gone.remove = {"control"};
  Change duplicate;
  duplicate.new_resources.push_back({data("speed"), {}});

  EXPECT_EQ(apply({}).error().message, "is empty: it says nothing that is to be different");
  EXPECT_EQ(apply(twice).error().message, "is changed twice in one change");
  EXPECT_EQ(apply(gone).error().message, "is removed and changed in the same change");
  EXPECT_EQ(apply(duplicate).error().message, "there is something of this name already");
  EXPECT_EQ(deployer.generation(), 1u);
}

TEST_F(Transactions, OfRulesAloneMakeAGenerationAndMayBeRolledBack) {
  deployer.run_for(20ms);
  Change rules_only;
  rules_only.changes_rules = true;
  rules_only.probation = Probation{.confirm_within = 50ms};

  const Result<Receipt> applied = apply(rules_only);

  ASSERT_TRUE(applied) << to_string(applied.error());
  EXPECT_EQ(applied->generation, 2u);
  EXPECT_TRUE(applied->components.empty());
  EXPECT_TRUE(deployer.on_probation());
  EXPECT_FALSE(apply(Change{{ramp::to_core<ramp::Up>("up")}}))
      << "this one awaits its confirmation";

  deployer.run_for(60ms);
  std::vector<Outcome> ends = test::tend(deployer);
  deployer.run_for(20ms);
  const std::vector<Outcome> more = test::tend(deployer);
  ends.insert(ends.end(), more.begin(), more.end());
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(ends[0].began, 2u);
  EXPECT_EQ(ends[0].generation, 3u);
}

TEST_F(Transactions, ReplaceAComponentUnderItsOwnName) {
  deployer.run_for(20ms);
  Change change;
  change.remove = {"control"};
  change.new_components.push_back({reader("control"), {{"in", "position.read", 0ms}}});

  const Result<Receipt> done = apply(change);
  ASSERT_TRUE(done) << to_string(done.error());
  deployer.run_for(50ms);

  EXPECT_EQ(deployer.status("control").type, "reader");
  EXPECT_EQ(deployer.status().size(), 1u);
  EXPECT_EQ(Reader::last(), -1.0) << "the safe value of the one that left";
}

TEST_F(Transactions, LetNothingJoinWhenTheLastPartIsRefused) {
  Change change;
  change.new_components.push_back({reader("reader"), {{"in", "position.read", 0ms}}});
  change.new_resources.push_back({data("other"), {}});
  change.edits = {ramp::to_core<ramp::ThrowingOnConfigure>("ramp/throwing")};

  const Result<Receipt> refused = apply(change);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::hook_threw);
  EXPECT_EQ(architecture.find_component("reader"), nullptr);
  EXPECT_EQ(architecture.find_resource("other"), nullptr);
  EXPECT_EQ(deployer.status().size(), 1u);
}

TEST_F(Transactions, ChangeTaskAttributesWithTheRest) {
  Edit edit = with_its_task();
  edit.task->priority = 33;
  edit.task->budget = 2ms;

  ASSERT_TRUE(apply({{edit}}));

  EXPECT_EQ(deployer.status("control").priority, 33);
  EXPECT_EQ(architecture.control.bundle()->task.budget, 2ms);
}

TEST_F(Transactions, MoveTheGridWithTheOffsetAndLoseNoRelease) {
  deployer.run_for(35ms);
  Edit edit = with_its_task();
  edit.task->offset = 3ms;

  ASSERT_TRUE(apply({{edit}}));
  deployer.run_for(30ms);

  EXPECT_EQ(deployer.status("control").next_release.count() % 10'000'000, 3'000'000);
  EXPECT_EQ(deployer.status("control").missed, 0u);
}

TEST_F(Transactions, RefuseAnotherStackForAThreadThatRuns) {
  Edit edit = with_its_task();
  edit.task->stack = 1 << 20;

  const Result<Receipt> refused = apply({{edit}});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.task.stack");
}

TEST_F(Transactions, SwapACoreOfAComponentThatIsStopped) {
  ASSERT_TRUE(deployer.stop({"control"}));

  const Result<Receipt> done = deployer.swap_core<ramp::Down>("control");

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(20ms);
  EXPECT_LT(ramp::read(architecture.position), 0.0);
}

TEST_F(Transactions, SwapToTheSameCoreKeepsItsState) {
  deployer.run_for(50ms);

  ASSERT_TRUE(deployer.swap_core<ramp::Up>("control"));
  deployer.run_for(10ms);

  EXPECT_GE(ramp::read(architecture.position), 6.0);
}

}  // namespace
}  // namespace mauve
