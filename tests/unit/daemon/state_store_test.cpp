// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/state_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "monitor/disk_watch.h"
#include "support/eventually.h"
#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

using protocol::Json;
using test::TempDir;

Generation with_number(std::uint64_t number, Confirmation mark = Confirmation::confirmed) {
  return {number,   "b007", "2026-01-31T12:00:00.000000Z", 1000, "param.set", "why", "",
          "/robot", mark};
}

Value named(const std::string& name) { return Value::Object{{"name", name}}; }

class StateStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    log.start();
    open();
  }
  void TearDown() override {
    if (store) {
      store->end();
    }
    log.stop();
  }
  void open() {
    store.reset();
    auto opened = StateStore::open((dir / "state").string(), log);
    ASSERT_TRUE(opened);
    store = std::move(*opened);
  }
  bool keep(const Generation& about, const std::string& name,
            StateStore::As as = StateStore::As::marked, std::uint64_t before_stops = 0) {
    std::promise<bool> saved;
    store->keep(
        about, named(name), {{"method", "param.set"}}, [&](bool done) { saved.set_value(done); },
        as, before_stops);
    return saved.get_future().get();
  }
  [[nodiscard]] std::string audit() const { return TempDir::read(dir / "state" / "audit.log"); }
  [[nodiscard]] std::size_t lines() const {
    const auto text = audit();
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  TempDir dir;
  logging::Log log{logging::Level::debug};
  std::unique_ptr<StateStore> store;
};

TEST_F(StateStoreTest, GivesAStopOfSeveralStagesTheMarkOfTheSystemBeforeIt) {
  store->begin(with_number(1), named("robot"));
  store->mark(1, Confirmation::confirmed);
  const auto stopped = [&](std::uint64_t number, std::uint64_t before_stops) {
    EXPECT_TRUE(keep(with_number(number), "stopped", StateStore::As::before, before_stops));
    return store->generations().mark_of(number);
  };

  EXPECT_EQ(stopped(4, 1), Confirmation::confirmed) << "the stop made 2, 3 and 4";
  EXPECT_EQ(stopped(8, 6), Confirmation::unconfirmed) << "6 is not saved: nothing vouches for it";
}

TEST_F(StateStoreTest, ReportsADiskThatDoesNotAnswerAndItsReturnOnceEach) {
  DiskWatch watch;
  store->begin(with_number(1), named("robot"));
  std::promise<void> begun;
  std::promise<void> answers;
  const auto before = std::chrono::steady_clock::now();
  store->disk().post([&] {
    begun.set_value();
    answers.get_future().wait();
  });
  begun.get_future().wait();
  const auto after = std::chrono::steady_clock::now();
  const auto reported = [&](logging::Event event) {
    log.flush();
    const auto records = log.history().tail(100, {});
    return std::ranges::count(records, event, &logging::Record::event);
  };

  const auto look = [&](DiskWatch::Instant now) {
    watch.look(store->disk().busy_since(), now, store->directory(), log);
  };

  look(before + DiskWatch::kSlow - std::chrono::nanoseconds(1));
  EXPECT_EQ(reported(logging::Event::disk_silent), 0);
  EXPECT_EQ(watch.silent_for(after), Duration{0});
  look(after + DiskWatch::kSlow);
  look(after + 2 * DiskWatch::kSlow);
  EXPECT_EQ(reported(logging::Event::disk_silent), 1);
  EXPECT_GE(watch.silent_for(after + DiskWatch::kSlow), DiskWatch::kSlow);

  answers.set_value();
  store->flush();
  // The job of flush() itself is under way until a moment after its end is reported.
  ASSERT_TRUE(test::eventually([&] { return !store->disk().busy_since(); }));
  look(after + 3 * DiskWatch::kSlow);
  look(after + 3 * DiskWatch::kSlow);
  EXPECT_EQ(reported(logging::Event::disk_answers), 1);
  EXPECT_EQ(watch.silent_for(after + 3 * DiskWatch::kSlow), Duration{0});
}

TEST_F(StateStoreTest, DoesNotBelieveAMarkerThatOthersMayHaveWritten) {
  store->begin(with_number(1), named("robot"));
  store->end();
  const auto marker = dir / "state/running";
  open();
  ASSERT_FALSE(store->last_run().crashed());

  std::filesystem::permissions(marker, std::filesystem::perms(0666));
  open();

  EXPECT_TRUE(store->last_run().crashed()) << "as if there were none";
}

TEST_F(StateStoreTest, KnowsACrashByAMissingEnd) {
  EXPECT_FALSE(store->last_run().crashed());
  store->begin(with_number(1), named("a"));
  store->end();
  open();
  EXPECT_FALSE(store->last_run().crashed());
  store->begin(with_number(2), named("a"));

  open();  // without an end

  EXPECT_TRUE(store->last_run().crashed());
  EXPECT_EQ(store->generations().newest(), 2U);
}

TEST_F(StateStoreTest, ContinuesForOneStartWhenTheFileContinueIsThere) {
  store->begin(with_number(1), named("a"));
  store->end();
  static_cast<void>(dir.write("state/continue", ""));

  open();

  EXPECT_TRUE(store->last_run().continues());
  EXPECT_FALSE(store->last_run().crashed());
  store->last_run().try_generation(1);
  static_cast<void>(dir.write("state/continue", ""));  // of an upgrade while this run goes on
  store->begin(with_number(2), named("a"));
  store->end();
  EXPECT_TRUE(std::filesystem::exists(dir / "state/continue"));
}

TEST_F(StateStoreTest, ContinuesWithTheNextStartWhenOneIsRefused) {
  store->begin(with_number(1), named("a"));
  store->end();
  static_cast<void>(dir.write("state/continue", ""));
  open();
  store->last_run().try_generation(1);
  store->last_run().refused();

  open();

  EXPECT_FALSE(store->last_run().continues()) << "the file was for one start";
  EXPECT_TRUE(store->last_run().crashed()) << "what ran before is tried again";
  EXPECT_EQ(store->last_run().crashed_generation(), 0U) << "but it has not crashed";
}

TEST_F(StateStoreTest, TakesALostMarkerForACrashWhenSomethingWasSaved) {
  store->begin(with_number(1), named("a"));
  store->end();
  std::filesystem::remove(dir / "state" / "running");

  open();

  EXPECT_TRUE(store->last_run().crashed());
  EXPECT_EQ(store->last_run().crashed_generation(), 0U) << "nobody knows what it had started";
}

TEST_F(StateStoreTest, CountsACrashOnceAndOnlySoonAfterTheStart) {
  store->last_run().try_generation(7);
  open();
  EXPECT_EQ(store->last_run().crashed_generation(), 0U) << "somebody killed it from outside";
  static_cast<void>(dir.write("state/fault", ""));  // by the last thread of a process that fails
  open();
  EXPECT_EQ(store->last_run().crashed_generation(), 7U);

  store->last_run().refused();  // a start after the crash that a hook refused
  open();
  EXPECT_TRUE(store->last_run().crashed()) << "what ran last is tried again";
  EXPECT_EQ(store->last_run().crashed_generation(), 0U) << "but it has not crashed again";

  store->begin(with_number(8), named("a"));
  store->ran_long();
  store->flush();
  open();
  EXPECT_TRUE(store->last_run().crashed());
  EXPECT_EQ(store->last_run().crashed_generation(), 0U);
}

TEST_F(StateStoreTest, DropsWhatEarlierRecoveriesDidNotConfirm) {
  for (std::uint64_t number = 1; number <= 3; ++number) {
    auto about = with_number(number);
    about.command = number == 1 ? "start" : kRecover;
    about.mark = number == 1 ? Confirmation::confirmed : Confirmation::unconfirmed;
    store->begin(about, named("a"));
    open();
  }

  const auto all = store->generations().list();

  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].number, 3U);
  EXPECT_EQ(all[1].number, 1U);
  log.flush();
  const auto records = log.history().tail(100, {});
  const auto removed =
      std::ranges::find(records, logging::Event::generation_removed, &logging::Record::event);
  ASSERT_NE(removed, records.end()) << "the log names the generation";
  EXPECT_TRUE(removed->text.starts_with("generation 2, ")) << removed->text;
}

/// Neither the change of a rule, nor the start of a run that ended in order.
TEST_F(StateStoreTest, DropsOnlyTheStartOfTheRunThatCrashed) {
  const auto unconfirmed = [](std::uint64_t number, const char* command) {
    auto about = with_number(number, Confirmation::unconfirmed);
    about.command = command;
    return about;
  };
  store->begin(unconfirmed(1, kStart), named("a"));
  store->end();
  open();
  store->begin(unconfirmed(2, kStart), named("a"));
  ASSERT_TRUE(keep(unconfirmed(3, "transaction"), "b"));
  ASSERT_TRUE(keep(unconfirmed(4, "restarted"), "b"));
  store->ran_long();
  store->flush();
  open();
  store->last_run().refused();  // a start after the crash that a hook refused
  open();
  store->begin(unconfirmed(5, kRecover), named("a"));

  std::vector<std::uint64_t> numbers;
  for (const auto& one : store->generations().list()) {
    numbers.push_back(one.number);
  }
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{5, 4, 3, 1}));
}

TEST_F(StateStoreTest, PutsAFileAsideThatLiesWhereTheGenerationsBelong) {
  store.reset();
  std::filesystem::remove_all(dir / "state" / "generations");
  std::ofstream(dir / "state" / "generations") << "damage";

  open();

  store->begin(with_number(1), named("a"));
  EXPECT_EQ(store->generations().newest(), 1U);
  EXPECT_TRUE(std::filesystem::exists(dir / "state" / "generations.damaged"));
}

TEST_F(StateStoreTest, KeepsTheListOfCoresInQuarantine) {
  const Json cores = {{{"core", "guidance/gap"}, {"build_id", "12ab"}, {"reason", "threw"}}};
  EXPECT_TRUE(store->quarantined().empty());
  store->begin(with_number(1), named("a"));
  store->quarantine(cores);
  store->end();

  open();

  EXPECT_EQ(store->quarantined(), cores);
}

TEST_F(StateStoreTest, SaysThatADamagedListOfCoresInQuarantineIsLost) {
  for (const char* text : {"", "[]", "{\"cores\":[1]}", "{\"cores\":[{"}) {
    store.reset();
    dir.write("state/quarantine.json", text);
    open();
    EXPECT_TRUE(store->quarantined().empty()) << text;
    log.flush();
    const auto records = log.history().tail(1, {});
    ASSERT_EQ(records.size(), 1U);
    EXPECT_EQ(records[0].event, logging::Event::quarantine_lost) << text;
  }
}

TEST_F(StateStoreTest, AnswersWhenTheGenerationIsOnTheDisk) {
  store->begin(with_number(1), named("a"));

  ASSERT_TRUE(keep(with_number(2), "b"));

  EXPECT_THAT(store->generations().text(2).value(), testing::HasSubstr("\"name\": \"b\""));
  EXPECT_THAT(audit(), testing::HasSubstr("\"saved\":true"));
  EXPECT_TRUE(store->saved());
}

TEST_F(StateStoreTest, MarksWhatWasSavedBefore) {
  store->begin(with_number(1), named("a"));
  ASSERT_TRUE(keep(with_number(2, Confirmation::unconfirmed), "b"));

  store->mark(2, Confirmation::confirmed);
  store->flush();

  EXPECT_EQ(store->generations().list().front().mark, Confirmation::confirmed);
}

TEST_F(StateStoreTest, SaysThatNothingWasSavedAndGoesOn) {
  store->begin(with_number(1), named("a"));
  std::filesystem::rename(dir / "state", dir / "away");

  EXPECT_FALSE(keep(with_number(2), "b"));
  EXPECT_FALSE(store->saved());
  store->audit({{"method", "param.set"}});
  store->flush();
  std::filesystem::rename(dir / "away", dir / "state");
  EXPECT_TRUE(keep(with_number(3), "c"));

  EXPECT_TRUE(store->saved());
  log.flush();
  const auto records = log.history().tail(100, {});
  const auto count = [&](logging::Event event) {
    return std::count_if(records.begin(), records.end(),
                         [&](const logging::Record& one) { return one.event == event; });
  };
  EXPECT_EQ(count(logging::Event::generation_not_saved), 1);
  EXPECT_EQ(count(logging::Event::audit_failed), 1) << "one complaint until it works again";
}

TEST_F(StateStoreTest, CountsAuditLinesThatTheDiskIsTooSlowFor) {
  // Nothing is written before begin(): as on a disk that does not answer.
  for (std::size_t i = 0; i < StateStore::kWaiting + 5; ++i) {
    store->audit({{"method", "param.set"}, {"time", "now"}});
  }

  store->begin(with_number(1), named("a"));
  store->flush();

  EXPECT_EQ(lines(), StateStore::kWaiting + 1);
  EXPECT_THAT(audit(), testing::HasSubstr("{\"lost\":5,\"time\":"));
}

TEST_F(StateStoreTest, WritesWhatWaitsBeforeItEnds) {
  store->begin(with_number(1), named("a"));
  for (int i = 0; i < 20; ++i) {
    store->audit({{"method", "param.set"}});
  }

  store->end();

  EXPECT_EQ(lines(), 20U);
  EXPECT_EQ(test::TempDir::read(dir / "state" / "running"), "ended\n");
}

TEST_F(StateStoreTest, ConfirmsTwoGenerationsThatAreTheSameAndNoOthers) {
  store->begin(with_number(1), named("a"));
  for (const auto& [number, name] : {std::pair{2U, "b"}, {3U, "c"}, {4U, "b"}}) {
    ASSERT_TRUE(keep(with_number(number, Confirmation::unconfirmed), name));
  }
  const auto mark_of = [this](std::uint64_t number) {
    store->flush();
    const auto all = store->generations().list();
    const auto found = std::ranges::find(all, number, &Generation::number);
    return found == all.end() ? std::string_view("gone") : to_string(found->mark);
  };

  store->confirm_same(2, 3);
  store->confirm_same(2, 77);
  EXPECT_EQ(mark_of(2), "unconfirmed");
  EXPECT_EQ(mark_of(3), "unconfirmed");

  store->confirm_same(2, 4);
  EXPECT_EQ(mark_of(2), "confirmed");
  EXPECT_EQ(mark_of(3), "unconfirmed");
  EXPECT_EQ(mark_of(4), "confirmed");
}

}  // namespace
}  // namespace mauve::daemon
