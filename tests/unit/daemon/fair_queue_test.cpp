// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/fair_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mauve::daemon {
namespace {

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
