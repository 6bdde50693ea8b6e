// SPDX-License-Identifier: LGPL-3.0-or-later
#include "judge/judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "support/eventually.h"

namespace mauve::daemon {
namespace {

using server::Role;

TEST(JudgeQueue, ServesOperatorsAndAdminsBeforeViewersAndUsersInTurns) {
  Control control;
  Judge judge(control);
  std::mutex mutex;
  std::vector<std::string> order;
  const auto ask = [&](Role role, uid_t uid, const std::string& name) {
    judge.ask({role, uid}, Question{""}, [&, name](const Result<Json>&) {
      const std::lock_guard lock(mutex);
      order.push_back(name);
    });
  };
  const auto all_are_served = [&] {
    const std::lock_guard lock(mutex);
    return order.size() == 5;
  };
  control.start();

  ask(Role::viewer, 1, "viewer 1");
  ask(Role::viewer, 1, "viewer 1 again");
  ask(Role::viewer, 2, "viewer 2");
  ask(Role::admin, 3, "admin");
  ask(Role::operator_, 4, "operator");
  judge.start({"/bin/true"}, Duration{std::chrono::seconds(10)});

  ASSERT_TRUE(test::eventually(all_are_served));
  EXPECT_THAT(order,
              testing::ElementsAre("admin", "operator", "viewer 1", "viewer 2", "viewer 1 again"));
  control.stop();
}

TEST(JudgeQueue, RefusesTheThirdFileOfAUserAtOnce) {
  Control control;
  Judge judge(control);
  std::atomic<int> refused{0};
  for (int i = 0; i < 3; ++i) {
    judge.ask({Role::viewer, 1}, Question{""}, [&](const Result<Json>& result) {
      refused += !result && result.error().code == Errc::limit ? 1 : 0;
    });
  }
  control.start();

  EXPECT_TRUE(test::eventually([&] { return refused == 1; }));
  control.stop();
}

}  // namespace
}  // namespace mauve::daemon
