// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "commands/recovery/abandoned.h"
#include "model/job/abandonable_thread.h"
#include "rt/time/cpu_time.h"
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

/// The first request of the viewer takes 300 ms of processor time, so that the second one waits for
/// 5.7 s unless the thread ends. All others come later, and are served before it.
TEST_F(ControlTest, ServesAllOthersWhileAViewerHasHadItsShare) {
  const Asker viewer{server::Role::viewer, 7};
  std::promise<void> served;
  control.read(
      [&] {
        const auto begin = rt::cpu_time();
        while (rt::cpu_time() - begin < std::chrono::milliseconds(300)) continue;
        control.read([&] { note("the same viewer"); }, viewer);
        control.read([&] { note("another viewer"); }, {server::Role::viewer, 8});
        control.read([&] { note("an operator"); }, {server::Role::operator_, 9});
        control.read([&] { note("a rule"); });
        control.read([&] { served.set_value(); }, {server::Role::viewer, 8});
      },
      viewer);
  served.get_future().wait();
  EXPECT_THAT(noted(), testing::ElementsAre("a rule", "an operator", "another viewer"));

  control.stop();
  EXPECT_EQ(noted().back(), "the same viewer") << "what is queued at the end is served";
}

TEST_F(ControlTest, CountsTheLongAnswersOfEachUserAndDropsAtItsEndThoseThatWait) {
  const Asker viewer{server::Role::viewer, 7};
  std::promise<void> begun;
  std::promise<void> release;
  control.write_out(
      [&] {
        begun.set_value();
        release.get_future().wait();
        note("first");
      },
      viewer);
  auto held = std::make_shared<int>(0);
  const std::weak_ptr<int> waits = held;
  control.write_out([&, held] { note("second"); }, viewer);
  held.reset();
  begun.get_future().wait();
  EXPECT_EQ(control.long_answers(7), 2U);
  EXPECT_EQ(control.long_answers(8), 0U);

  std::thread end([&] { control.stop(); });
  EXPECT_TRUE(test::eventually([&] { return waits.expired(); }));
  release.set_value();
  end.join();

  EXPECT_THAT(noted(), testing::ElementsAre("first"));
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

TEST_F(ControlTest, ServesAnOperatorNextWhateverViewersHaveQueued) {
  std::promise<void> release;
  control.read([&] { release.get_future().wait(); });
  for (uid_t uid = 1; uid <= 3; ++uid) {
    for (int i = 0; i < 64; ++i) {
      control.read([&] { note("view"); }, {server::Role::viewer, uid});
    }
  }
  control.read([&] { note("operate"); }, {server::Role::operator_, 4});
  ASSERT_TRUE(control.change([&](const Control::Ticket&) { note("change"); },
                             {server::Role::operator_, 4}));

  release.set_value();
  ASSERT_TRUE(test::eventually([&] { return noted().size() == 3 * 64 + 2; }));

  const auto all = noted();
  EXPECT_THAT((std::vector<std::string>{all[0], all[1]}),
              testing::UnorderedElementsAre("operate", "change"));
}

TEST_F(ControlTest, PreparesAChangeBeforeWhatOthersOnlyLookAt) {
  std::promise<void> release;
  control.in_factory([&] { release.get_future().wait(); }, [] {});
  for (int i = 0; i < 64; ++i) {
    control.in_factory([&] { note("look"); }, [] {}, {}, {server::Role::viewer, 1});
  }
  control.in_factory([&] { note("prepare"); }, [] {});

  release.set_value();
  ASSERT_TRUE(test::eventually([&] { return noted().size() == 65; }));

  EXPECT_EQ(noted().front(), "prepare");
}

TEST_F(ControlTest, LetsUsersTakeTurnsWithTheirChanges) {
  std::promise<void> release;
  auto released = release.get_future().share();
  ASSERT_TRUE(control.change([&](Control::Ticket ticket) {
    control.in_factory([released] { released.wait(); }, [ticket = std::move(ticket)] {});
  }));
  for (const auto* name : {"a1", "a2"}) {
    ASSERT_TRUE(control.change([&, name](const Control::Ticket&) { note(name); },
                               {server::Role::operator_, 1}));
  }
  ASSERT_TRUE(
      control.change([&](const Control::Ticket&) { note("b1"); }, {server::Role::admin, 2}));

  release.set_value();

  ASSERT_TRUE(test::eventually([&] { return noted().size() == 3; }));
  EXPECT_THAT(noted(), testing::ElementsAre("a1", "b1", "a2"));
}

TEST_F(ControlTest, BeginsTheNextChangeAlsoWhenOneIsDropped) {
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

/// Gives work up that takes longer than a moment, when it is looked after.
class FactoryTest : public ControlTest {
 protected:
  FactoryTest() : hasty(std::chrono::milliseconds(1)) {}
  void SetUp() override { hasty.start(); }
  void TearDown() override {
    released = true;
    EXPECT_TRUE(test::eventually([&] { return hasty.abandoned_threads().empty(); }));
  }

  void wait_for_release() const {
    while (!released) {
      std::this_thread::yield();
    }
  }
  /// Work that does not return before the test is over.
  auto hanging(std::shared_ptr<void> held = nullptr) {
    return [this, held = std::move(held)] {
      InHook hook("first.core", "on_configure");
      wait_for_release();
      returned_whole = hook.back();
    };
  }
  /// Looks until a thread was abandoned, or `times` times.
  std::vector<AbandonedThread> look(int times = 20'000) {
    std::vector<AbandonedThread> left;
    for (int i = 0; left.empty() && i < times; ++i) {
      std::promise<void> done;
      hasty.read([&] {
        left = hasty.look_after_factory();
        done.set_value();
      });
      done.get_future().wait();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return left;
  }

  std::atomic<bool> released{false};
  std::atomic<bool> returned_whole{true};
  Control hasty;
};

TEST_F(FactoryTest, GivesWorkUpAndGoesOnWithTheNextChange) {
  auto elements = std::make_shared<int>(1);
  const std::weak_ptr<int> alive = elements;
  ASSERT_TRUE(hasty.change([&, elements = std::move(elements)](Control::Ticket ticket) mutable {
    hasty.in_factory(
        hanging(elements), [&, elements, ticket] { note("prepared"); },
        [&](const std::string& hook) { note("abandoned in " + hook); });
    elements.reset();
  }));
  ASSERT_TRUE(hasty.change([&](const Control::Ticket& ticket) {
    hasty.in_factory([] {}, [&, ticket] { note("second"); });
  }));

  const auto left = look();

  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].hook, "first.core on_configure");
  ASSERT_TRUE(test::eventually([&] { return noted().size() == 2; }));
  EXPECT_THAT(noted(), testing::ElementsAre("abandoned in first.core on_configure", "second"));
  EXPECT_EQ(hasty.abandoned_threads().size(), 1U);
  EXPECT_FALSE(alive.expired()) << "the abandoned thread may still touch it";

  released = true;
  EXPECT_TRUE(test::eventually([&] { return alive.expired(); }));
  EXPECT_FALSE(returned_whole);
  EXPECT_THAT(noted(), testing::Not(testing::Contains("prepared")));
}

TEST_F(FactoryTest, EndsWhileAThreadIsAbandoned) {
  hasty.in_factory(hanging(), [] {});
  ASSERT_EQ(look().size(), 1U);

  hasty.stop();

  EXPECT_EQ(hasty.abandoned_threads().size(), 1U);
}

TEST_F(FactoryTest, GivesNothingUpThatUsesTheModel) {
  hasty.in_factory(
      [this] {
        const Inside inside;
        wait_for_release();
      },
      [] {});

  EXPECT_TRUE(look(50).empty());
  EXPECT_TRUE(hasty.abandoned_threads().empty());
}

TEST_F(FactoryTest, GivesNothingUpThatIsQueuedOnly) {
  hasty.in_factory([] {}, [&] { note("done"); });
  ASSERT_TRUE(test::eventually([&] { return noted().size() == 1; }));

  EXPECT_TRUE(look(50).empty());
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

TEST(AbandonedThreads, AreAtMostTwoOfOneUserAndEightInAll) {
  std::vector<AbandonedThread> left;
  const auto leave = [&](std::optional<uid_t> user) { left.push_back({"a hook", {}, user}); };
  leave(1000);
  EXPECT_TRUE(may_prepare(left, 1000));
  leave(1000);

  ASSERT_FALSE(may_prepare(left, 1000));
  EXPECT_THAT(may_prepare(left, 1000).error().message, testing::HasSubstr("2 hooks of changes"));
  EXPECT_TRUE(may_prepare(left, 1001)) << "another user does not suffer";
  for (int i = 0; i < 5; ++i) leave(std::nullopt);
  EXPECT_TRUE(may_prepare(left, 1001));
  EXPECT_TRUE(may_prepare(left, std::nullopt)) << "a rule has no share of its own";
  leave(1001);
  ASSERT_FALSE(may_prepare(left, 1002));
  EXPECT_THAT(may_prepare(left, 1002).error().message, testing::HasSubstr("8 threads"));
  EXPECT_FALSE(may_prepare(left, std::nullopt));
}

}  // namespace
}  // namespace mauve::daemon
