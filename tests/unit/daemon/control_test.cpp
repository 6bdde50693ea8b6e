// SPDX-License-Identifier: LGPL-3.0-or-later
#include "control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <vector>

#include "support/eventually.h"

namespace mauve::daemon {
namespace {

/// Runs a job on [control] and waits for it.
void settle(Control& control) {
  std::promise<void> done;
  control.read([&] { done.set_value(); });
  done.get_future().wait();
}

class ControlTest : public testing::Test {
 protected:
  void SetUp() override { control.start(); }
  void note(const std::string& what) {
    const std::lock_guard lock(mutex);
    notes.push_back(what);
  }
  std::vector<std::string> noted() {
    const std::lock_guard lock(mutex);
    return notes;
  }

  std::mutex mutex;
  std::vector<std::string> notes;
  Control control;
};

TEST_F(ControlTest, RunsReadsInOrder) {
  control.read([&] { note("a"); });
  control.read([&] { note("b"); });
  settle(control);

  EXPECT_THAT(noted(), testing::ElementsAre("a", "b"));
}

TEST_F(ControlTest, RunsChangesOneAtATime) {
  std::promise<void> release;
  auto released = release.get_future().share();
  ASSERT_TRUE(control.change([&](Control::Ticket ticket) {
    control.in_factory([released] { released.wait(); },
                       [&, ticket = std::move(ticket)] { note("first"); });
  }));
  ASSERT_TRUE(control.change([&](const Control::Ticket&) { note("second"); }));
  settle(control);
  EXPECT_TRUE(control.busy());
  EXPECT_THAT(noted(), testing::IsEmpty());

  release.set_value();

  ASSERT_TRUE(test::eventually([&] { return noted().size() == 2; }));
  EXPECT_THAT(noted(), testing::ElementsAre("first", "second"));
}

TEST_F(ControlTest, ServesReadsWhileAChangeIsPrepared) {
  std::promise<void> release;
  auto released = release.get_future().share();
  ASSERT_TRUE(control.change([&](Control::Ticket ticket) {
    control.in_factory([released] { released.wait(); },
                       [&, ticket = std::move(ticket)] { note("change"); });
  }));

  control.read([&] { note("read"); });
  settle(control);

  EXPECT_THAT(noted(), testing::ElementsAre("read"));
  release.set_value();
  EXPECT_TRUE(test::eventually([&] { return !control.busy(); }));
}

TEST_F(ControlTest, LetsUrgentJobsOvertake) {
  std::promise<void> release;
  control.read([&] { release.get_future().wait(); });
  control.read([&] { note("read"); });
  control.urgent([&] { note("urgent"); });

  release.set_value();
  settle(control);

  EXPECT_THAT(noted(), testing::ElementsAre("urgent", "read"));
}

TEST_F(ControlTest, BeginsTheNextChangeAlsoWhenOneIsGivenUp) {
  ASSERT_TRUE(control.change([](const Control::Ticket&) {}));
  ASSERT_TRUE(control.change([&](const Control::Ticket&) { note("second"); }));

  EXPECT_TRUE(test::eventually([&] { return noted().size() == 1; }));
}

TEST_F(ControlTest, RefusesAChangeWhenTooManyWait) {
  std::promise<void> release;
  const auto wait = [this, released = release.get_future().share()](Control::Ticket ticket) {
    control.in_factory([released] { released.wait(); }, [ticket = std::move(ticket)] {});
  };
  std::size_t accepted = 0;
  while (control.change(wait)) {
    ++accepted;
  }

  EXPECT_GE(accepted, Control::kWaiting);
  release.set_value();
}

TEST_F(ControlTest, ContinuesOnTheControlThread) {
  std::promise<bool> where;
  control.in_factory([&] { EXPECT_FALSE(control.on_control_thread()); },
                     [&] { where.set_value(control.on_control_thread()); });

  EXPECT_TRUE(where.get_future().get());
}

TEST_F(ControlTest, DropsWaitingChangesWhenItStops) {
  std::promise<void> release;
  auto released = release.get_future().share();
  ASSERT_TRUE(control.change([&](Control::Ticket ticket) {
    control.in_factory([released] { released.wait(); },
                       [&, ticket = std::move(ticket)] { note("first"); });
  }));
  auto held = std::make_shared<int>(1);
  ASSERT_TRUE(control.change([&, held](const Control::Ticket&) { note("second"); }));
  release.set_value();

  control.stop();

  EXPECT_THAT(noted(), testing::Not(testing::Contains("third")));
  EXPECT_EQ(held.use_count(), 1);
  EXPECT_FALSE(control.change([&](const Control::Ticket&) { note("third"); }));
}

}  // namespace
}  // namespace mauve::daemon
