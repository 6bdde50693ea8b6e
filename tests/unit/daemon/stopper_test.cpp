// SPDX-License-Identifier: LGPL-3.0-or-later
/// A stop that [control], here the thread of the test, leaves alone. On real threads.
#include "changes/stopper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve::daemon {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Names = std::vector<std::string>;

class StopperTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    stopper.start(deployer, 0, [this](bool now) {
      hastens = now;
      if (now) ++hastened;
    });
  }
  /// The deployer outlives it.
  void TearDown() override { stopper.stop(); }

  std::shared_ptr<StopOrder> order(Names components, bool applies = true) {
    return std::make_shared<StopOrder>(
        std::move(components), [applies] { return applies; },
        [this](const DirectStop& direct, const Names& all) {
          ran = all;
          run_still = direct.run_still();
          ++reports;
          return true;
        });
  }
  [[nodiscard]] bool stops(const char* component) {
    return test::eventually(
        [&] { return deployer.status(component).state == ComponentState::stopped; });
  }

  ramp::Two<ramp::Up> architecture;
  Deployer deployer{architecture, {.realtime = Realtime::off}};
  logging::Log log{logging::Level::debug};
  Stopper stopper{log};
  Names run_still{"no report"};
  Names ran;
  std::atomic<int> reports{0};
  std::atomic<bool> hastens{false};
  std::atomic<int> hastened{0};
};

TEST_F(StopperTest, CarriesOutAStopThatIsNeverServedAlsoWhileControlDoesOtherThings) {
  const auto stop = order({"left"});
  stopper.watch(stop);

  EXPECT_TRUE(stops("left")) << "each look of eventually() is one of [control]";
  EXPECT_TRUE(test::eventually([&] { return reports == 1; }));
  EXPECT_THAT(run_still, IsEmpty());
  EXPECT_THAT(stop->stopped_directly(), ElementsAre("left"));
  EXPECT_EQ(deployer.status("right").state, ComponentState::running);
  EXPECT_TRUE(stop->begin()) << "[control] learns that it was carried out";
}

TEST_F(StopperTest, CarriesOutAStopThatIsServedButNotLookedAfter) {
  const auto stop = order({});
  EXPECT_FALSE(stop->begin());
  stopper.watch(stop);

  ASSERT_TRUE(test::eventually([&] { return reports == 1; }));
  EXPECT_THAT(run_still, IsEmpty());
  EXPECT_THAT(stop->stopped_directly(), ElementsAre("left", "right")) << "none named: all";
}

/// [stop] reports the third order, which came after both others. So it is done with both.
TEST_F(StopperTest, LeavesAloneWhatIsOverOrWouldBeRefused) {
  const auto over = order({"right"});
  over->end(deployer);
  const auto refused = order({"right"}, false);
  const auto last = order({"left"});
  for (const auto& one : {over, refused, last}) stopper.watch(one);

  ASSERT_TRUE(test::eventually([&] { return reports == 1; }));
  EXPECT_THAT(over->stopped_directly(), IsEmpty());
  EXPECT_THAT(refused->stopped_directly(), IsEmpty());
  EXPECT_EQ(deployer.status("right").state, ComponentState::running);
}

TEST_F(StopperTest, KeepsComponentsParkedUntilControlHasDoneTheBooks) {
  const auto stop = order({"left"});
  stopper.watch(stop);
  ASSERT_TRUE(test::eventually([&] { return reports == 1; }));
  ASSERT_TRUE(stops("left"));
  static_cast<void>(deployer.start({"left"}));
  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);

  stop->end(deployer);

  EXPECT_TRUE(deployer.start({"left"}));
  EXPECT_TRUE(
      test::eventually([&] { return deployer.status("left").state == ComponentState::running; }));
}

TEST_F(StopperTest, NamesTheComponentsThatControlHadParkedBeforeItWasHeldUp) {
  const auto stop = order({"left"});
  EXPECT_FALSE(stop->begin());
  stop->found({"left"});
  ASSERT_TRUE(deployer.stop({"left"}));

  stopper.watch(stop);  // and [control] looks no more

  ASSERT_TRUE(test::eventually([&] { return reports == 1; }));
  EXPECT_THAT(ran, ElementsAre("left"));
  EXPECT_THAT(stop->stopped_directly(), ElementsAre("left"));
}

TEST_F(StopperTest, HastensControlWhileAStopIsWatched) {
  const auto stop = order({"left"});

  stopper.watch(stop);
  EXPECT_TRUE(test::eventually([&] { return hastened > 0; }));
  stop->end(deployer);

  EXPECT_TRUE(test::eventually([&] { return !hastens; }));
}

/// [stop] looks at all of them many times before it carries out the second one.
TEST_F(StopperTest, ReportsEachStopOnce) {
  stopper.watch(order({"left"}));
  ASSERT_TRUE(test::eventually([&] { return reports == 1; }));

  const auto later = std::make_shared<std::atomic<int>>(0);
  stopper.watch(std::make_shared<StopOrder>(
      Names{"right"}, [] { return true; },
      [later](const DirectStop&, const Names&) { return ++*later > 0; }));
  ASSERT_TRUE(test::eventually([&] { return *later == 1; }));

  EXPECT_EQ(reports, 1);
}

}  // namespace
}  // namespace mauve::daemon
