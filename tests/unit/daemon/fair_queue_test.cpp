// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/fair_queue.h"
#include "changes/viewer_share.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mauve::daemon {
namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using server::Role;
using testing::ElementsAre;

constexpr Asker kViewer{Role::viewer, 1};
constexpr Asker kOtherViewer{Role::viewer, 2};
constexpr Asker kOperator{Role::operator_, 3};
constexpr Asker kAdmin{Role::admin, 4};

class TheFairQueue : public testing::Test {
 protected:
  std::vector<std::string> pop_all() {
    std::vector<std::string> all;
    while (!queue.empty()) all.push_back(queue.pop());
    return all;
  }
  FairQueue<std::string> queue;
};

TEST_F(TheFairQueue, ServesAnOperatorBeforeAllThatViewersHaveQueued) {
  for (uid_t uid = 10; uid < 14; ++uid) {
    for (int i = 0; i < 64; ++i) queue.push({Role::viewer, uid}, "view");
  }
  queue.push(kOperator, "start");
  EXPECT_EQ(queue.size(), 4 * 64 + 1U);

  EXPECT_EQ(queue.pop(), "start");
  EXPECT_EQ(queue.pop(), "view");
}

TEST_F(TheFairQueue, ServesWhatMauvedDoesByItselfFirst) {
  queue.push(kViewer, "view");
  queue.push(kAdmin, "apply");
  queue.push({}, "rule");

  EXPECT_THAT(pop_all(), ElementsAre("rule", "apply", "view"));
}

TEST_F(TheFairQueue, LetsUsersTakeTurnsWhateverOneHasQueued) {
  for (const auto* item : {"a1", "a2", "a3"}) queue.push(kViewer, item);
  queue.push(kOtherViewer, "b1");

  EXPECT_EQ(queue.pop(), "a1");
  queue.push({Role::viewer, 9}, "c1");

  EXPECT_THAT(pop_all(), ElementsAre("b1", "a2", "c1", "a3"));
}

TEST_F(TheFairQueue, PassesOverViewersThatHaveHadTheirShare) {
  queue.push(kViewer, "a1");
  queue.push(kViewer, "a2");
  queue.push(kOtherViewer, "b1");
  const auto without_a = [](uid_t viewer) { return viewer != kViewer.uid; };

  EXPECT_EQ(queue.pop(without_a), "b1");
  EXPECT_FALSE(queue.has(without_a));
  EXPECT_EQ(queue.pop(without_a), std::nullopt);
  queue.push({Role::operator_, kViewer.uid}, "start");
  EXPECT_EQ(queue.pop(without_a), "start") << "operators have no share";
  EXPECT_THAT(pop_all(), ElementsAre("a1", "a2"));
}

TEST(TheShareOfAViewer, IsOneTwentiethOfTheTime) {
  const auto now = ViewerShare::Clock::now();
  ViewerShare share;
  EXPECT_TRUE(share.may(1, now));
  EXPECT_EQ(share.next(now), std::nullopt);

  share.served(1, 2ms, now);
  EXPECT_FALSE(share.may(1, now + 38ms - 1ns));
  EXPECT_TRUE(share.may(1, now + 38ms));
  EXPECT_TRUE(share.may(2, now));
  EXPECT_EQ(share.next(now), now + 38ms);

  share.served(2, 1ms, now + 1ms);
  EXPECT_EQ(share.next(now + 1ms), now + 20ms);
  EXPECT_EQ(share.next(now + 20ms), now + 38ms);
}

TEST_F(TheFairQueue, TakesAdminsAndOperatorsInTurn) {
  for (const auto* item : {"a1", "a2"}) queue.push(kAdmin, item);
  for (const auto* item : {"o1", "o2"}) queue.push(kOperator, item);

  EXPECT_THAT(pop_all(), ElementsAre("a1", "o1", "a2", "o2"));
}

TEST_F(TheFairQueue, KeepsTheOrderOfEachUser) {
  for (const auto* item : {"1", "2"}) queue.push(kViewer, item);
  queue.push(kOtherViewer, "other");
  queue.push(kViewer, "3");

  EXPECT_THAT(pop_all(), ElementsAre("1", "other", "2", "3"));
  queue.push(kViewer, "4");
  EXPECT_EQ(queue.pop(), "4");
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace mauve::daemon
