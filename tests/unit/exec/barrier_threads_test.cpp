// SPDX-License-Identifier: LGPL-3.0-or-later
/// The barrier on real threads: members that do not come, stops, and many exchanges.
#include <gtest/gtest.h>

#include <thread>

#include "support/eventually.h"
#include "support/store.h"

namespace mauve {
namespace {

using test::eventually;

class BarrierOfThreads : public testing::Test {
 protected:
  void SetUp() override {
    store::forget_counts();
    architecture.left.fsm().period = 3ms;
    architecture.left.task().watchdog = 1h;  // no guard ends the job that is held
    architecture.right.fsm().period = 1ms;
    ASSERT_TRUE(deployer.deploy());
    ASSERT_TRUE(eventually([] { return store::counts().written > 10; }));
  }
  void TearDown() override { store::counts().hold = false; }
  /// "left" is in a job that does not end until it is let go.
  void hold_left() {
    store::counts().hold = true;
    ASSERT_TRUE(eventually([] { return store::counts().holding.load(); }));
  }
  Result<Receipt> to_second() {
    return deployer.apply(store::change_to(store::make<store::Second>("two")));
  }
  /// No write was lost, and none went into the wrong store.
  void expect_nothing_lost() {
    static_cast<void>(deployer.shutdown());  // writes two safe values
    EXPECT_EQ(store::writes(architecture), static_cast<double>(store::counts().written) + 2);
  }

  store::Architecture architecture;
  Deployer deployer{architecture, {.realtime = Realtime::off, .admission = Admission::off}};
};

TEST_F(BarrierOfThreads, ChangesNothingWhenAMemberDoesNotCome) {
  hold_left();

  const Result<Receipt> refused = test::refused_for(
      [&] { return to_second(); }, [](const Error& error) { return error.at == "left"; });

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_EQ(refused.error().at, "left");
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_EQ(architecture.find_resource("store"), &architecture.resource);
  const std::uint64_t releases = deployer.status("right").releases;
  EXPECT_TRUE(eventually([&] { return deployer.status("right").releases > releases + 10; }))
      << "it goes on as before";
  EXPECT_GT(deployer.status("right").missed, 0u);

  store::counts().hold = false;
  EXPECT_TRUE(eventually([&] { return to_second().has_value(); })) << "and nobody is held for good";
  EXPECT_EQ(store::counts().wrong, 0);
}

TEST_F(BarrierOfThreads, WaitsForTheLastWriteOfALateJob) {
  hold_left();
  auto change = deployer.prepare(store::change_to(store::make<store::Second>("two")));
  ASSERT_TRUE(change) << to_string(change.error());
  const std::shared_ptr<Ongoing> ongoing = deployer.begin(*change);
  EXPECT_FALSE(ongoing->advance());
  store::counts().hold = false;  // now it writes, when the other has long been waiting

  Result<Receipt> done = deployer.wait(*ongoing);
  if (!done) done = to_second();  // a disturbed machine: it was held too long

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(store::counts().wrong, 0);
  expect_nothing_lost();
}

TEST_F(BarrierOfThreads, IsCalledOffByAStopOfWhoWaits) {
  hold_left();
  auto change = deployer.prepare(store::change_to(store::make<store::Second>("two")));
  ASSERT_TRUE(change) << to_string(change.error());
  const std::shared_ptr<Ongoing> ongoing = deployer.begin(*change);
  EXPECT_FALSE(ongoing->advance());

  const Result<Receipt> stopped = deployer.stop({"right"});

  ASSERT_TRUE(stopped) << to_string(stopped.error());
  EXPECT_EQ(deployer.status("right").state, ComponentState::stopped);
  EXPECT_TRUE(store::counts().hold) << "the other is still in its job";
  const Result<Receipt> refused = deployer.wait(*ongoing);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::conflict);
  EXPECT_EQ(architecture.find_resource("store"), &architecture.resource);
}

TEST_F(BarrierOfThreads, EndsWithTheSystem) {
  hold_left();
  auto change = deployer.prepare(store::change_to(store::make<store::Second>("two")));
  ASSERT_TRUE(change) << to_string(change.error());
  const std::shared_ptr<Ongoing> ongoing = deployer.begin(*change);
  EXPECT_FALSE(ongoing->advance());
  store::counts().hold = false;

  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());
}

TEST_F(BarrierOfThreads, LosesNoWriteInManyExchanges) {
  int done = 0;
  for (int i = 0; i < 40; ++i) {
    const bool forth = done % 2 == 0;
    const auto change = forth ? store::change_to(store::make<store::Second>("two"))
                              : store::change_to(store::make<store::First>("one"), 1);
    // On a machine that is overloaded some are revoked: then nothing changed.
    if (deployer.apply(change)) ++done;
  }

  EXPECT_GT(done, 0);
  EXPECT_EQ(deployer.generation(), static_cast<std::uint64_t>(1 + done));
  EXPECT_EQ(store::counts().wrong, 0);
  EXPECT_EQ(deployer.status("left").next_release.count() % 3'000'000, 0);
  expect_nothing_lost();
}

}  // namespace
}  // namespace mauve
