// SPDX-License-Identifier: LGPL-3.0-or-later
/// The state of a running core that is replaced.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>

#include "exec/commit/commit.h"
#include "exec/system/make_update.h"
#include "support/positions.h"

namespace mauve {
namespace {

/// A core of revision 1 that has climbed to 20 m.
class HandOver : public testing::Test {
 protected:
  void SetUp() override {
    ramp::written().clear();
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(200ms);
    ASSERT_EQ(position(), 20.0);
  }
  double position() { return ramp::read(architecture.position); }
  const void* object() {
    return architecture.control.ComponentBase::core().declared_state()->data();
  }
  template <typename T>
  Result<Receipt> swap(StatePolicy policy = StatePolicy::keep) {
    return deployer.swap_core("control", CoreType::of<T>("test/next"), policy);
  }

  ramp::One<ramp::First> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

/// "ramp_position/1 (layout 0123abcd, 16 B)"
template <typename T>
std::string shown() {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "%s (layout %08x, %zu B)", data_type<T>().name.c_str(),
                static_cast<unsigned>(data_type<T>().layout >> 32U), sizeof(T));
  return text.data();
}

TEST_F(HandOver, MovesTheObjectOfAStateOfTheSameType) {
  const void* const before = object();

  const Result<Receipt> done = swap<ramp::Lone<ramp::PositionV1>>();
  deployer.run_for(10ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(object(), before);
  EXPECT_EQ(done->components[0].bytes, sizeof(ramp::PositionV1));
  EXPECT_EQ(position(), 21.0);
}

TEST_F(HandOver, ConvertsAStateOfAnotherRevision) {
  const Result<Receipt> done = swap<ramp::Second>();
  deployer.run_for(10ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(position(), 19.0);
  EXPECT_EQ(done->components[0].bytes, sizeof(ramp::PositionV1)) << "of the state handed over";
  EXPECT_EQ(done->components[0].missed, 0u);
}

TEST_F(HandOver, RefusesAStateThatTheNewCoreCannotConvert) {
  const Result<Receipt> refused = swap<ramp::Lone<ramp::PositionV2>>();
  deployer.run_for(10ms);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::type_mismatch);
  EXPECT_EQ(refused.error().at, "control.core");
  EXPECT_EQ(refused.error().message, "the new core has the state " + shown<ramp::PositionV2>() +
                                         ", but the core in force has " +
                                         shown<ramp::PositionV1>() +
                                         ", which the new core cannot convert");
  EXPECT_EQ(refused.error().hint,
            "say --state drop to start it fresh, or declare a mauve::Converts in the new core");
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_EQ(position(), 21.0) << "the old core goes on";
}

TEST_F(HandOver, RefusesAnotherLayoutUnderTheSameRevision) {
  const Result<Receipt> refused = swap<ramp::Lone<ramp::ChangedV1>>();

  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(shown<ramp::ChangedV1>()), std::string::npos);
  EXPECT_NE(shown<ramp::ChangedV1>(), shown<ramp::PositionV1>());
}

TEST_F(HandOver, RefusesACoreThatSaysNothingOfItsState) {
  const Result<Receipt> refused = swap<ramp::Forgetful>();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "the new core has no place for the state " +
                                         shown<ramp::PositionV1>() +
                                         " of the core in force, and does not say that it needs "
                                         "none");
  EXPECT_EQ(refused.error().hint,
            "say --state drop to start it fresh, or declare mauve::State or mauve::Stateless in "
            "the new core");
}

TEST(HandOverOfSeveral, NamesEachStateThatTheProposedDropWouldDropToo) {
  ramp::Two<ramp::First, ramp::First> architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Change change;
  change.edits.push_back(ramp::to_core<ramp::Lone<ramp::PositionV2>>("test/other", "left"));
  change.edits.push_back(ramp::to_core<ramp::Lone<ramp::PositionV1>>("test/same", "right"));

  const auto refused = deployer.prepare(change);
  change.edits.pop_back();
  const auto alone = deployer.prepare(change);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "left.core");
  EXPECT_EQ(refused.error().hint,
            "say --state drop to start it fresh, or declare a mauve::Converts in the new core; "
            "--state drop is for the whole change, and also drops the state of: right");
  ASSERT_FALSE(alone);
  EXPECT_EQ(alone.error().hint,
            "say --state drop to start it fresh, or declare a mauve::Converts in the new core");
}

TEST_F(HandOver, DropsAStateForACoreThatSaysItIsStatelessOnlyWhenTheChangeSaysDrop) {
  struct Plain : ramp::RampCore {
    Stateless stateless{*this};
    void update() override { shell().out.write(5.0); }
  };

  const Result<Receipt> refused = swap<Plain>();
  const Result<Receipt> done = swap<Plain>(StatePolicy::drop);
  deployer.run_for(10ms);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::type_mismatch);
  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->components[0].bytes, 0u);
  EXPECT_EQ(done->components[0].dropped, "ramp_position/1");
  EXPECT_EQ(done->components[0].dropped_bytes, 16u);
  EXPECT_EQ(position(), 5.0);
  EXPECT_TRUE(swap<ramp::First>()) << "and what comes after it starts fresh";
}

TEST_F(HandOver, StartsFreshWhenTheChangeSaysDrop) {
  const Result<Receipt> done = swap<ramp::Lone<ramp::PositionV2>>(StatePolicy::drop);
  deployer.run_for(10ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->components[0].bytes, 0u);
  EXPECT_EQ(position(), 1.0);
}

TEST_F(HandOver, NeverJumpsByMoreThanOneStepInFiftySwapsBetweenRevisions) {
  for (int i = 0; i < 50; ++i) {
    const Result<Receipt> done = i % 2 == 0 ? swap<ramp::Second>() : swap<ramp::First>();
    ASSERT_TRUE(done) << to_string(done.error());
    deployer.run_for(i % 3 * 10ms);
  }

  double last = 0;
  for (const double value : ramp::written()) {
    EXPECT_EQ(std::abs(value - last), 1.0);
    last = value;
  }
  EXPECT_GE(ramp::written().size(), 20u + 49u);
  EXPECT_EQ(deployer.status("control").missed, 0u);
}

TEST_F(HandOver, KeepsACounterExactInAnySequenceOfSwaps) {
  const std::uint32_t seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto one_of = [&](unsigned n) { return static_cast<int>(random() % n); };

  for (int i = 0; i < 300; ++i) {
    const int next = one_of(3);
    const Result<Receipt> done = next == 0   ? swap<ramp::First>()
                                 : next == 1 ? swap<ramp::Second>()
                                             : swap<ramp::Third>();
    ASSERT_TRUE(done) << to_string(done.error());
    deployer.run_for(one_of(5) * 10ms);
    const StateBase& state = *architecture.control.ComponentBase::core().declared_state();
    const Value shown = state.type().to_value(state.data());
    ASSERT_EQ(*shown.find("jobs"), Value(static_cast<std::int64_t>(ramp::written().size())));
    ASSERT_EQ(deployer.status("control").releases, ramp::written().size());
  }
}

/// The bundle before the last change, on its rollback.
std::unique_ptr<exec::TaskUpdate> rollback(ComponentBase& component,
                                           std::shared_ptr<const Bundle> old) {
  exec::PreparedMember member;
  member.component = &component;
  member.base = component.bundle();
  member.next = std::move(old);
  auto update = exec::make_update(member);
  EXPECT_FALSE(update->hand_over.run().happened());
  return update;
}

TEST_F(HandOver, GoesBackToTheValueItHadWhenThereIsNoConverterBack) {
  ASSERT_TRUE(swap<ramp::Lone<ramp::PositionV1>>());
  const std::shared_ptr<const Bundle> old = architecture.control.bundle();
  ASSERT_TRUE(swap<ramp::Second>());
  deployer.run_for(50ms);

  const auto update = rollback(architecture.control, old);

  EXPECT_EQ(update->hand_over.bytes, 0u);
  EXPECT_EQ(static_cast<const ramp::PositionV1*>(old->core->declared_state()->data())->metres,
            20.0);
}

TEST_F(HandOver, GoesOnFromTheLaterValueWhenThereIsAConverterBack) {
  const std::shared_ptr<const Bundle> old = architecture.control.bundle();
  ASSERT_TRUE(swap<ramp::Second>());
  deployer.run_for(50ms);

  const auto update = rollback(architecture.control, old);

  EXPECT_EQ(update->hand_over.bytes, sizeof(ramp::PositionV2));
  EXPECT_EQ(static_cast<const ramp::PositionV1*>(old->core->declared_state()->data())->metres,
            15.0);
}

/// A swap to the core that counts in millimetres, on probation.
Change to_second() {
  Edit edit;
  edit.member = "control";
  edit.core = CoreType::of<ramp::Second>("test/second");
  Change change;
  change.edits.push_back(std::move(edit));
  change.probation = Probation{};
  return change;
}

TEST_F(HandOver, SaysBeforeAndAfterAConversionThatARollbackContinuesWithTheEarlierState) {
  ASSERT_TRUE(swap<ramp::Lone<ramp::PositionV1>>());
  const std::vector<std::string> notes = {
      "control: a rollback continues with the state from before the change (ramp_position/1): its "
      "core has no converter from ramp_position/2, so its outputs may jump"};

  auto prepared = deployer.prepare(to_second());
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  EXPECT_EQ(deployer.foresee(*prepared).notes, notes);
  EXPECT_EQ(deployer.foresee(*prepared).components[0].converted,
            "ramp_position/1 -> ramp_position/2");
  Retired retired;
  const Result<Receipt> done = deployer.commit(*prepared, retired);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->notes, notes);
  EXPECT_EQ(done->components[0].converted, "ramp_position/1 -> ramp_position/2");
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_EQ(deployer.probations()[0].notes, notes) << "which undo says";
  deployer.run_for(50ms);
  ASSERT_EQ(position(), 15.0);
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(10ms);
  EXPECT_EQ(position(), 21.0) << "it jumps";
}

TEST_F(HandOver, SaysThatACoreBeginsFreshWhereTheCoreBeforeDeclaresNoState) {
  ASSERT_TRUE(swap<ramp::Forgetful>(StatePolicy::drop));
  const std::string back =
      "control: a rollback returns to the values that the core before had at the change, since it "
      "declares no state; its outputs may jump";
  const std::vector<std::string> notes = {
      "control: the new core begins fresh, since the core before declares neither a state to hand "
      "over (mauve::State) nor that it has none (mauve::Stateless)",
      back};

  auto prepared = deployer.prepare(to_second());
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  EXPECT_EQ(deployer.foresee(*prepared).notes, notes);
  Retired retired;
  const Result<Receipt> done = deployer.commit(*prepared, retired);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->notes, notes);
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_EQ(deployer.probations()[0].notes, std::vector<std::string>{back}) << "which undo says";
}

TEST_F(HandOver, SaysNothingOfAFreshCoreThatTheChangeAsksFor) {
  ASSERT_TRUE(swap<ramp::Forgetful>(StatePolicy::drop));

  const Result<Receipt> done = swap<ramp::First>(StatePolicy::drop);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_TRUE(done->notes.empty());
}

/// A rollback brings back the core from before both changes, not that from before the second.
TEST_F(HandOver, SaysOfJoinedChangesThatTheirRollbackContinuesWithTheEarliestState) {
  ASSERT_TRUE(swap<ramp::Lone<ramp::PositionV1>>());
  ASSERT_TRUE(deployer.apply(to_second()));
  Change again = to_second();
  again.edits[0].core = CoreType::of<ramp::Third>("test/third");

  const Result<Receipt> done = deployer.apply(again);

  ASSERT_TRUE(done) << to_string(done.error());
  const std::string note =
      "control: a rollback continues with the state from before the change (ramp_position/1): its "
      "core has no converter from ramp_position/3, so its outputs may jump";
  ASSERT_FALSE(done->notes.empty());
  EXPECT_EQ(done->notes[0], note);
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_EQ(deployer.probations()[0].notes, std::vector<std::string>{note});
}

/// The state changes its owner with the first change, and is converted by the second one. The core
/// in between keeps it for the rollback.
TEST_F(HandOver, GoesBackOverJoinedChangesToTheLastStateOfTheTypeBefore) {
  ASSERT_TRUE(swap<ramp::Lone<ramp::PositionV1>>());
  Change exchange = to_second();
  exchange.edits[0].core = CoreType::of<ramp::Lone<ramp::PositionV1>>("test/again");
  ASSERT_TRUE(deployer.apply(exchange));
  deployer.run_for(50ms);
  ASSERT_EQ(position(), 25.0);
  ASSERT_TRUE(deployer.apply(to_second()));
  deployer.run_for(50ms);
  ASSERT_EQ(position(), 20.0);

  ASSERT_TRUE(deployer.undo());
  deployer.run_for(10ms);

  EXPECT_EQ(position(), 26.0) << "one step after the state before the conversion";
}

/// From a core that converts nothing, through any changes on one probation, and back.
TEST(JoinedHandOvers, GoBackToTheLastStateOfTheTypeBefore) {
  std::mt19937 random(7);
  for (int run = 0; run < 200; ++run) {
    ramp::One<ramp::Lone<ramp::PositionV1>> architecture;
    Deployer deployer(architecture, {.simulated = true});
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(100ms);
    double last = ramp::read(architecture.position);
    std::string story;
    int type = 1;
    for (auto changes = 1 + random() % 6; changes > 0; --changes) {
      const auto kind = random() % (type == 1 ? 4 : 3);
      Change change = to_second();
      change.edits[0].core = kind == 0   ? CoreType::of<ramp::Second>("test/second")
                             : kind == 1 ? CoreType::of<ramp::Third>("test/third")
                             : kind == 2 ? CoreType::of<ramp::First>("test/first")
                                         : CoreType::of<ramp::Lone<ramp::PositionV1>>("test/lone");
      if (random() % 5 == 0) change.edits[0].state = StatePolicy::drop;
      story += " " + change.edits[0].core->name;
      const bool drops = change.edits[0].state == StatePolicy::drop;
      if (drops) story += " (drop)";
      ASSERT_TRUE(deployer.apply(change)) << story;
      if (drops) break;  // the rollback continues with the state before it
      type = kind == 0 ? 2 : kind == 1 ? 3 : 1;
      deployer.run_for(10ms * (1 + static_cast<int>(random() % 3)));
      if (type == 1) last = ramp::read(architecture.position);
    }

    ASSERT_TRUE(deployer.undo()) << story;
    deployer.run_for(10ms);

    EXPECT_EQ(ramp::read(architecture.position), last + 1) << story;
  }
}

TEST_F(HandOver, SaysNothingOfJoinedChangesOfWhichTheSecondConvertsTheStateBack) {
  ASSERT_TRUE(swap<ramp::Lone<ramp::PositionV1>>());
  ASSERT_TRUE(deployer.apply(to_second()));
  Change back = to_second();
  back.edits[0].core = CoreType::of<ramp::First>("test/first");

  const Result<Receipt> done = deployer.apply(back);

  ASSERT_TRUE(done) << to_string(done.error());
  for (const std::string& note : done->notes) {
    EXPECT_EQ(note.find("its core has no converter"), std::string::npos) << note;
  }
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_TRUE(deployer.probations()[0].notes.empty());
}

TEST_F(HandOver, SaysNothingOfARollbackThatConvertsTheStateBack) {
  const Result<Receipt> done = deployer.apply(to_second());

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->components[0].converted, "ramp_position/1 -> ramp_position/2");
  EXPECT_TRUE(done->notes.empty());
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_TRUE(deployer.probations()[0].notes.empty());
}

}  // namespace
}  // namespace mauve
