// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes of a contract between members, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "support/eventually.h"
#include "support/store.h"

namespace mauve {
namespace {

class Barrier : public testing::Test {
 protected:
  void SetUp() override {
    store::forget_counts();
    architecture.left.fsm().period = 10ms;
    architecture.right.fsm().period = 100us;
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(100ms);
  }
  [[nodiscard]] static std::int64_t written() { return store::counts().written; }
  [[nodiscard]] double known() const { return store::writes(architecture); }

  store::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true, .admission = Admission::off}};
};

TEST_F(Barrier, LosesNoWriteOfAResourceThatChangesItsContract) {
  const std::int64_t before = written();
  ASSERT_GT(before, 1000);

  const Result<Receipt> done = deployer.apply(store::change_to(store::make<store::Second>("two")));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_GT(written(), before) << "a job released before the instant ran when others waited";
  EXPECT_EQ(known(), static_cast<double>(written()));
  deployer.run_for(50ms);
  EXPECT_EQ(known(), static_cast<double>(written()));
  EXPECT_EQ(store::counts().wrong, 0) << "nobody saw the contract of the others";
  EXPECT_EQ(done->generation, 2u);
  ASSERT_EQ(done->components.size(), 3u);
  EXPECT_EQ(done->components[2].name, "store");
  EXPECT_EQ(done->components[2].bytes, sizeof(store::Total1));
}

TEST_F(Barrier, GoesOnOnTheGridsAndCountsWhatWasLost) {
  const Result<Receipt> done = deployer.apply(store::change_to(store::make<store::Second>("two")));
  deployer.run_for(50ms);

  ASSERT_TRUE(done) << to_string(done.error());
  const ComponentStatus left = deployer.status("left");
  const ComponentStatus right = deployer.status("right");
  EXPECT_EQ(left.missed, 0u) << "none of its releases lay in the gap";
  EXPECT_EQ(left.next_release.count() % 10'000'000, 0);
  EXPECT_GT(right.missed, 0u);
  EXPECT_EQ(right.next_release.count() % 100'000, 0);
  EXPECT_EQ(static_cast<std::int64_t>(right.releases + right.missed),
            right.next_release.count() / 100'000);
  EXPECT_EQ(done->components[1].missed, right.missed);
  EXPECT_EQ(done->components[1].pause, 100us * static_cast<std::int64_t>(right.missed));
  EXPECT_EQ(left.state, ComponentState::running);
}

TEST_F(Barrier, IsNotSeenAsAStop) {
  std::vector<std::string> kinds;
  static_cast<void>(deployer.drain([](const RuntimeEvent&) {}));

  ASSERT_TRUE(deployer.apply(store::change_to(store::make<store::Second>("two"))));

  static_cast<void>(deployer.drain([&](const RuntimeEvent& one) { kinds.push_back(one.event); }));
  EXPECT_EQ(kinds, (std::vector<std::string>{"swapped", "swapped"}));
}

TEST_F(Barrier, IsNotTheCutWhichStartsFresh) {
  Change change = store::change_to(store::make<store::Lone>("lone"));
  change.sync = Sync::cut;

  const Result<Receipt> done = deployer.apply(change);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_LT(known(), 10.0);
  EXPECT_EQ(deployer.status("right").missed, 0u);
}

TEST_F(Barrier, RefusesAStateThatTheNewResourceCannotTake) {
  const Result<Receipt> refused =
      deployer.apply(store::change_to(store::make<store::Lone>("lone")));
  const Result<Receipt> dropped =
      deployer.apply(store::change_to(store::make<store::Lone>("lone"), 1000, StatePolicy::drop));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::type_mismatch);
  EXPECT_EQ(refused.error().at, "store.core");
  EXPECT_NE(refused.error().hint.find("--state drop"), std::string::npos);
  ASSERT_TRUE(dropped) << to_string(dropped.error());
  EXPECT_EQ(dropped->generation, 2u);
  EXPECT_LT(known(), 10.0);
}

TEST_F(Barrier, ChangesOtherThingsThanContractsToo) {
  Change change;
  change.edits.resize(1);
  change.edits[0].member = "right";
  change.edits[0].properties.emplace_back("core.value", 2.0);
  change.sync = Sync::barrier;

  const Result<Receipt> done = deployer.apply(change);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_GT(done->components[0].missed, 0u);
  EXPECT_EQ(known(), static_cast<double>(written()));
}

TEST_F(Barrier, LeavesAStoppedMemberStopped) {
  ASSERT_TRUE(deployer.stop({"right"}));

  ASSERT_TRUE(deployer.apply(store::change_to(store::make<store::Second>("two"))));
  deployer.run_for(50ms);
  EXPECT_EQ(deployer.status("right").state, ComponentState::stopped);

  ASSERT_TRUE(deployer.start({"right"}));
  deployer.run_for(50ms);
  EXPECT_EQ(known(), static_cast<double>(written()) + 1) << "and the safe value of the stop";
  EXPECT_EQ(store::counts().wrong, 0);
}

TEST_F(Barrier, ParksAMemberThatLeavesWithItsSafeValue) {
  Change change = store::change_to(store::make<store::Second>("two"));
  change.edits.pop_back();
  change.remove.emplace_back("right");

  const Result<Receipt> done = deployer.apply(change);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(architecture.find_component("right"), nullptr);
  EXPECT_EQ(deployer.status().size(), 1u);
}

TEST_F(Barrier, ChangesNothingWhileSomebodyIsInsideTheResource) {
  std::atomic<bool> held{false};
  std::atomic<bool> released{false};
  std::thread caller([&] {
    const ScopedLock scope(architecture.resource.lock());
    held = true;
    while (!released) std::this_thread::sleep_for(1ms);
  });
  ASSERT_TRUE(test::eventually([&] { return held.load(); }));

  const Result<Receipt> refused =
      deployer.apply(store::change_to(store::make<store::Second>("two")));
  released = true;
  caller.join();
  deployer.run_for(50ms);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_EQ(refused.error().at, "store");
  EXPECT_EQ(architecture.find_resource("store"), &architecture.resource);
  EXPECT_EQ(known(), static_cast<double>(written())) << "all go on as before";
  EXPECT_TRUE(deployer.apply(store::change_to(store::make<store::Second>("two"))));
}

TEST_F(Barrier, RefusesWhenTheResourceWasChangedMeanwhile) {
  auto change = deployer.prepare(store::change_to(store::make<store::Second>("two")));
  ASSERT_TRUE(change) << to_string(change.error());
  ASSERT_TRUE(deployer.apply(store::change_to(store::make<store::Second>("other"))));
  Retired retired;

  const Result<Receipt> refused = deployer.commit(*change, retired);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::conflict);
  EXPECT_EQ(deployer.generation(), 2u);
}

// --- on probation -------------------------------------------------------------------------------

TEST_F(Barrier, IsRolledBackByTheCutToTheStateOfTheBarrier) {
  Change change = store::change_to(store::make<store::Second>("two"));
  change.probation = Probation{.activations = 1'000'000};
  ASSERT_TRUE(deployer.apply(change));
  const double at_barrier = known();
  deployer.run_for(50ms);
  ASSERT_GT(known(), at_barrier);

  ASSERT_TRUE(deployer.undo());
  deployer.run_for(20ms);
  Retired retired;
  ASSERT_EQ(deployer.tend(retired).size(), 1u);

  EXPECT_EQ(architecture.find_resource("store"), &architecture.resource);
  EXPECT_GE(known(), at_barrier) << "goes on from there";
  EXPECT_LE(known(), at_barrier + 220);
  EXPECT_EQ(store::counts().wrong, 0);
  const store::Total1& total = *architecture.resource.core().state;
  EXPECT_EQ(total.sum, static_cast<double>(total.writes)) << "and got no safe value";
  EXPECT_EQ(deployer.status("left").state, ComponentState::running);
}

TEST_F(Barrier, CopiesAStateThatFitsWhenItMayComeBackAndMovesItElse) {
  for (const bool on_probation : {true, false}) {
    const ResourceBase& old = *architecture.find_resource("store");
    const void* const object = old.core().declared_state()->data();
    auto other = store::make<store::Same>("same");
    const ResourceBase& now = *other;
    Change change = store::change_to(std::move(other));
    if (on_probation) change.probation = Probation{.activations = 1'000'000};

    ASSERT_TRUE(deployer.apply(change));

    EXPECT_EQ(now.core().declared_state()->data() == object, !on_probation);
    EXPECT_GT(known(), 1000.0);
  }
}

struct Words : Core<store::NoPorts> {
  State<std::vector<std::string>> words{*this};
  void add(const double& value) { words->push_back(std::to_string(value)); }
  double writes() { return static_cast<double>(words->size()); }
};

TEST_F(Barrier, RefusesAProbationForWhatIsNotPlainBytes) {
  ASSERT_TRUE(
      deployer.apply(store::change_to(store::make<Words>("words/1"), 1, StatePolicy::drop)));
  deployer.run_for(10ms);
  const double before = known();
  Change change = store::change_to(store::make<Words>("words/2"));
  change.probation = Probation{};

  const Result<Receipt> refused = deployer.apply(change);
  change = store::change_to(store::make<Words>("words/2"));
  const Result<Receipt> done = deployer.apply(change);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::unsupported);
  EXPECT_NE(refused.error().hint.find("--probation off"), std::string::npos);
  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_GE(known(), before);
}

// --- resources that write on ------------------- -------------------------------------------------

struct RelayShell : Shell {
  WritePort<double> next{*this, "next", Safe{-1.0}};
};
struct Relay : Core<RelayShell> {
  Stateless stateless{*this};
  Property<double> factor{*this, "factor", 1.0, "of what it writes on"};
  void add(const double& value) { static_cast<void>(shell().next.write(value * factor)); }
  double writes() { return 0; }
};

struct Chained : Architecture {
  Resource<store::NoPorts, store::First, store::Face<store::First>> resource{*this, "store"};
  Resource<RelayShell, Relay, store::Face<Relay>> relay{*this, "relay"};
  Component<store::WriterShell, store::Writer, store::WriterFsm> caller{*this, "caller"};
  Status on_configure() override {
    caller.fsm().period = 100us;
    if (auto done = relay.connect("next", resource.interface().add, resource.keep_alive()); !done) {
      return done;
    }
    return caller.shell().out.connect(relay.interface().add);
  }
};

TEST(BarrierOfAChain, KeepsThoseOutThatReachTheResourceThroughAnother) {
  store::forget_counts();
  Chained architecture;
  Deployer deployer(architecture, {.simulated = true, .admission = Admission::off});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(10ms);
  Change change;
  change.remove = {"store"};
  change.new_resources.push_back({store::make<store::Second>("two"), {}});
  change.edits.resize(1);
  change.edits[0].member = "relay";
  change.edits[0].disconnect = {"next"};
  change.edits[0].connect = {{"next", "store.add", 0ms}};
  change.edits[0].properties.emplace_back("core.factor", 1000.0);
  change.sync = Sync::barrier;

  const Result<Receipt> done = deployer.apply(change);
  ASSERT_TRUE(done) << to_string(done.error());
  deployer.run_for(10ms);

  EXPECT_EQ(store::writes(architecture), static_cast<double>(store::counts().written));
  EXPECT_EQ(store::counts().wrong, 0);
  const ComponentStatus caller = deployer.status("caller");
  EXPECT_GT(caller.missed, 0u) << "it waited too";
  EXPECT_FALSE(caller.changing) << "it waits for nobody any more";
  EXPECT_EQ(static_cast<std::int64_t>(caller.releases + caller.missed),
            caller.next_release.count() / 100'000);
  const store::Total1& old = *architecture.resource.core().state;
  EXPECT_EQ(old.sum, static_cast<double>(old.writes)) << "it got no safe value";
  ASSERT_EQ(done->components.size(), 3u);
  EXPECT_EQ(done->components[1].name, "caller");
  EXPECT_EQ(done->components[1].missed, caller.missed);
}

}  // namespace
}  // namespace mauve
