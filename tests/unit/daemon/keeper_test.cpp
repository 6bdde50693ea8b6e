// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/keeper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

using protocol::Json;
using test::TempDir;

Generation with_number(std::uint64_t number, Mark mark = Mark::confirmed) {
  return {number,   "b007", "2026-01-31T12:00:00.000000Z", 1000, "param.set", "why", "",
          "/robot", mark};
}

Value named(const std::string& name) { return Value::Object{{"name", name}}; }

class KeeperTest : public testing::Test {
 protected:
  void SetUp() override {
    log.start();
    open();
  }
  void TearDown() override {
    if (keeper) {
      keeper->end();
    }
    log.stop();
  }
  void open() {
    keeper.reset();
    auto opened = Keeper::open((dir / "state").string(), log);
    ASSERT_TRUE(opened);
    keeper = std::move(*opened);
  }
  bool keep(const Generation& about, const std::string& name) {
    std::promise<bool> saved;
    keeper->keep(about, named(name), {{"method", "param.set"}},
                 [&](bool done) { saved.set_value(done); });
    return saved.get_future().get();
  }
  [[nodiscard]] std::string audit() const { return TempDir::read(dir / "state" / "audit.log"); }
  [[nodiscard]] std::size_t lines() const {
    const auto text = audit();
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  TempDir dir;
  logging::Log log{logging::Level::debug};
  std::unique_ptr<Keeper> keeper;
};

TEST_F(KeeperTest, DoesNotBelieveAMarkerThatOthersMayHaveWritten) {
  keeper->begin(with_number(1), named("robot"));
  keeper->end();
  const auto marker = dir / "state/running";
  open();
  ASSERT_FALSE(keeper->crashed());

  std::filesystem::permissions(marker, std::filesystem::perms(0666));
  open();

  EXPECT_TRUE(keeper->crashed()) << "as if there were none";
}

TEST_F(KeeperTest, KnowsACrashByAMissingEnd) {
  EXPECT_FALSE(keeper->crashed());
  keeper->begin(with_number(1), named("a"));
  keeper->end();
  open();
  EXPECT_FALSE(keeper->crashed());
  keeper->begin(with_number(2), named("a"));

  open();  // without an end

  EXPECT_TRUE(keeper->crashed());
  EXPECT_EQ(keeper->generations().newest(), 2U);
}

TEST_F(KeeperTest, TakesALostMarkerForACrashWhenSomethingWasSaved) {
  keeper->begin(with_number(1), named("a"));
  keeper->end();
  std::filesystem::remove(dir / "state" / "running");

  open();

  EXPECT_TRUE(keeper->crashed());
  EXPECT_EQ(keeper->crashed_generation(), 0U) << "nobody knows what it had started";
}

TEST_F(KeeperTest, CountsACrashOnceAndOnlySoonAfterTheStart) {
  keeper->try_generation(7);
  open();
  EXPECT_EQ(keeper->crashed_generation(), 7U);

  keeper->refused();  // a start after the crash that a hook refused
  open();
  EXPECT_TRUE(keeper->crashed()) << "what ran last is tried again";
  EXPECT_EQ(keeper->crashed_generation(), 0U) << "but it has not crashed again";

  keeper->begin(with_number(8), named("a"));
  keeper->ran_long();
  keeper->flush();
  open();
  EXPECT_TRUE(keeper->crashed());
  EXPECT_EQ(keeper->crashed_generation(), 0U);
}

TEST_F(KeeperTest, DropsWhatEarlierRecoveriesDidNotConfirm) {
  for (std::uint64_t number = 1; number <= 3; ++number) {
    auto about = with_number(number);
    about.command = number == 1 ? "start" : kRecover;
    about.mark = number == 1 ? Mark::confirmed : Mark::unconfirmed;
    keeper->begin(about, named("a"));
    open();
  }

  const auto all = keeper->generations().list();

  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].number, 3U);
  EXPECT_EQ(all[1].number, 1U);
}

TEST_F(KeeperTest, PutsAFileAsideThatLiesWhereTheGenerationsBelong) {
  keeper.reset();
  std::filesystem::remove_all(dir / "state" / "generations");
  std::ofstream(dir / "state" / "generations") << "damage";

  open();

  keeper->begin(with_number(1), named("a"));
  EXPECT_EQ(keeper->generations().newest(), 1U);
  EXPECT_TRUE(std::filesystem::exists(dir / "state" / "generations.damaged"));
}

TEST_F(KeeperTest, KeepsTheListOfCoresInQuarantine) {
  const Json cores = {{{"core", "guidance/gap"}, {"build_id", "12ab"}, {"reason", "threw"}}};
  EXPECT_TRUE(keeper->quarantined().empty());
  keeper->begin(with_number(1), named("a"));
  keeper->quarantine(cores);
  keeper->end();

  open();

  EXPECT_EQ(keeper->quarantined(), cores);
}

TEST_F(KeeperTest, SaysThatADamagedListOfCoresInQuarantineIsLost) {
  for (const char* text : {"", "[]", "{\"cores\":[1]}", "{\"cores\":[{"}) {
    keeper.reset();
    dir.write("state/quarantine.json", text);
    open();
    EXPECT_TRUE(keeper->quarantined().empty()) << text;
    log.flush();
    const auto told = log.history().tail(1, {});
    ASSERT_EQ(told.size(), 1U);
    EXPECT_EQ(told[0].event, logging::Event::quarantine_lost) << text;
  }
}

TEST_F(KeeperTest, AnswersWhenTheGenerationIsOnTheDisk) {
  keeper->begin(with_number(1), named("a"));

  ASSERT_TRUE(keep(with_number(2), "b"));

  EXPECT_THAT(keeper->generations().text(2).value(), testing::HasSubstr("\"name\": \"b\""));
  EXPECT_THAT(audit(), testing::HasSubstr("\"saved\":true"));
  EXPECT_TRUE(keeper->saved());
}

TEST_F(KeeperTest, MarksWhatWasSavedBefore) {
  keeper->begin(with_number(1), named("a"));
  ASSERT_TRUE(keep(with_number(2, Mark::unconfirmed), "b"));

  keeper->mark(2, Mark::confirmed);
  keeper->flush();

  EXPECT_EQ(keeper->generations().list().front().mark, Mark::confirmed);
}

TEST_F(KeeperTest, SaysThatNothingWasSavedAndGoesOn) {
  keeper->begin(with_number(1), named("a"));
  std::filesystem::rename(dir / "state", dir / "away");

  EXPECT_FALSE(keep(with_number(2), "b"));
  EXPECT_FALSE(keeper->saved());
  keeper->audit({{"method", "param.set"}});
  keeper->flush();
  std::filesystem::rename(dir / "away", dir / "state");
  EXPECT_TRUE(keep(with_number(3), "c"));

  EXPECT_TRUE(keeper->saved());
  log.flush();
  const auto told = log.history().tail(100, {});
  const auto count = [&](logging::Event event) {
    return std::count_if(told.begin(), told.end(),
                         [&](const logging::Record& one) { return one.event == event; });
  };
  EXPECT_EQ(count(logging::Event::generation_not_saved), 1);
  EXPECT_EQ(count(logging::Event::audit_failed), 1) << "one complaint until it works again";
}

TEST_F(KeeperTest, CountsAuditLinesThatTheDiskIsTooSlowFor) {
  // Nothing is written before begin(): as on a disk that does not answer.
  for (std::size_t i = 0; i < Keeper::kWaiting + 5; ++i) {
    keeper->audit({{"method", "param.set"}, {"time", "now"}});
  }

  keeper->begin(with_number(1), named("a"));
  keeper->flush();

  EXPECT_EQ(lines(), Keeper::kWaiting + 1);
  EXPECT_THAT(audit(), testing::HasSubstr("{\"lost\":5,\"time\":"));
}

TEST_F(KeeperTest, WritesWhatWaitsBeforeItEnds) {
  keeper->begin(with_number(1), named("a"));
  for (int i = 0; i < 20; ++i) {
    keeper->audit({{"method", "param.set"}});
  }

  keeper->end();

  EXPECT_EQ(lines(), 20U);
  EXPECT_EQ(test::TempDir::read(dir / "state" / "running"), "ended\n");
}

TEST_F(KeeperTest, ConfirmsTwoGenerationsThatAreTheSameAndNoOthers) {
  keeper->begin(with_number(1), named("a"));
  for (const auto& [number, name] : {std::pair{2U, "b"}, {3U, "c"}, {4U, "b"}}) {
    ASSERT_TRUE(keep(with_number(number, Mark::unconfirmed), name));
  }
  const auto mark_of = [this](std::uint64_t number) {
    keeper->flush();
    const auto all = keeper->generations().list();
    const auto found = std::ranges::find(all, number, &Generation::number);
    return found == all.end() ? std::string_view("gone") : to_string(found->mark);
  };

  keeper->confirm_same(2, 3);
  keeper->confirm_same(2, 77);
  EXPECT_EQ(mark_of(2), "unconfirmed");
  EXPECT_EQ(mark_of(3), "unconfirmed");

  keeper->confirm_same(2, 4);
  EXPECT_EQ(mark_of(2), "confirmed");
  EXPECT_EQ(mark_of(3), "unconfirmed");
  EXPECT_EQ(mark_of(4), "confirmed");
}

}  // namespace
}  // namespace mauve::daemon
