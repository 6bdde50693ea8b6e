// SPDX-License-Identifier: LGPL-3.0-or-later
/// The list of stops on the disk.
#include "state/stops/kept_stops.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <string>
#include <vector>

#include "commands/stops.h"
#include "state/state_store.h"
#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

const UserStop kBy{1000, "2026-01-31T12:00:00Z", 0};

class KeptStopsTest : public testing::Test {
 protected:
  void SetUp() override { log.start(); }
  void TearDown() override { log.stop(); }
  [[nodiscard]] std::filesystem::path file() const { return dir / "stops.json"; }
  /// The list that the next run reads.
  [[nodiscard]] UserStops next_run() { return KeptStops(dir.path(), log).read(); }
  /// Stands the stop of this component in the next run?
  [[nodiscard]] bool stands(const char* component) { return next_run().of(component) != nullptr; }

  test::TempDir dir;
  logging::Log log{logging::Level::debug};
  KeptStops kept{dir.path(), log};
  UserStops now;
};

TEST_F(KeptStopsTest, OutliveTheRunByNameAndOfAll) {
  now.stop("arm", kBy);
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_TRUE(stands("arm"));
  EXPECT_FALSE(stands("base"));
  EXPECT_EQ(next_run().of("arm")->uid, 1000u);
  EXPECT_EQ(next_run().of("arm")->time, kBy.time);

  now.stop_all(kBy);
  now.start("arm", now.newest());
  now.stop("base", kBy);
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_FALSE(stands("arm")) << "a user has started it";
  EXPECT_TRUE(stands("base"));
  EXPECT_TRUE(stands("joins_later"));

  now.start_all(now.newest());
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_FALSE(stands("base"));
}

TEST_F(KeptStopsTest, NeedNoFileWhereNobodyStoppedAnything) {
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_FALSE(std::filesystem::exists(file()));
  EXPECT_FALSE(stands("arm"));
}

TEST_F(KeptStopsTest, NameTheCauseAndNoUserWhereMauvedItselfStopped) {
  now.stop_all({0, kBy.time, 0, "the guardian is gone"});
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  ASSERT_TRUE(stands("arm"));
  EXPECT_EQ(next_run().of("arm")->cause, "the guardian is gone");
  EXPECT_EQ(in_words(*next_run().of("arm")),
            std::string("mauved stopped it at ") + kBy.time + ": the guardian is gone");
}

/// The names of both files change places with each write.
TEST_F(KeptStopsTest, AreWrittenManyTimesAndAlsoOverAFileThatSomebodyPutThere) {
  for (int i = 0; i < 5; ++i) {
    now.stop("arm" + std::to_string(i), kBy);
    kept.keep(now);
    ASSERT_TRUE(kept.write());
    EXPECT_EQ(next_run().named().size(), now.named().size());
    if (i == 2) {
      std::filesystem::remove(file());
    }
    if (i == 3) {
      std::filesystem::remove(file().string() + ".new");
      std::filesystem::copy_file(file(), file().string() + ".other");
      std::filesystem::rename(file().string() + ".other", file());
    }
  }
}

/// Nobody knows what was stopped, so nothing runs.
TEST_F(KeptStopsTest, StopAllWhenTheirFileIsDamaged) {
  now.stop("arm", kBy);
  kept.keep(now);
  ASSERT_TRUE(kept.write());
  const auto whole = test::TempDir::read(file());
  std::vector<std::string> texts{"",
                                 "{}",
                                 "[]",
                                 "null",
                                 "{\"components\":[]}",
                                 R"({"components":{"arm":{}}})",
                                 R"({"components":{"arm":{"uid":"x","time":"y"}}})",
                                 R"({"components":{"arm":{"cause":"","time":"y"}}})",
                                 R"({"all":1,"components":{}})",
                                 R"({"all":{"uid":1,"time":"t"},"components":{}})",
                                 R"({"all":{"uid":1,"time":"t"},"started":[1],"components":{}})"};
  for (std::size_t length = 1; length + 2 < whole.size(); ++length) {
    texts.push_back(whole.substr(0, length));
  }
  for (const auto& text : texts) {
    dir.write("stops.json", text);
    EXPECT_TRUE(stands("arm")) << text;
    EXPECT_TRUE(stands("joins_later")) << text;
  }
  std::filesystem::remove(file());
  std::filesystem::create_directory(file());
  EXPECT_TRUE(stands("arm")) << "a folder in its place";
}

TEST_F(KeptStopsTest, ReportToEachThatWaitsWhetherTheDiskTookThem) {
  std::filesystem::create_directory(file());  // no file can get this name
  std::vector<bool> saved;
  now.stop("arm", kBy);
  kept.keep(now, [&](bool done) { saved.push_back(done); });
  kept.keep(now, [&](bool done) { saved.push_back(done); });
  EXPECT_FALSE(kept.write());
  EXPECT_EQ(saved, (std::vector<bool>{false, false}));

  std::filesystem::remove(file());
  EXPECT_TRUE(kept.write()) << "it is written again with the next change";
  EXPECT_TRUE(stands("arm"));
}

/// [control] does not know it yet, and saves other lists meanwhile.
TEST_F(KeptStopsTest, HoldAStopThatWasCarriedOutWithoutControlUntilControlHasIt) {
  auto order = std::make_shared<int>(0);
  bool saved = false;
  kept.keep_directly(order, {"arm"}, kBy, [&](bool done) { saved = done; });
  EXPECT_TRUE(kept.write());
  EXPECT_TRUE(saved);
  now.stop("base", kBy);
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_TRUE(stands("arm"));
  EXPECT_TRUE(stands("base"));

  now.stop("arm", kBy);
  kept.keep(now);
  kept.served(order);
  EXPECT_TRUE(kept.write());
  EXPECT_TRUE(stands("arm"));
  now.start("arm", now.newest());
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_FALSE(stands("arm"));

  order = std::make_shared<int>(0);
  kept.keep_directly(order, {}, kBy, [](bool) {});
  EXPECT_TRUE(kept.write());
  EXPECT_TRUE(stands("joins_later"));
}

/// It is carried out without [control] after [control] has come to it, and reported late.
TEST_F(KeptStopsTest, HoldNoStopOnThatControlHasAlready) {
  const auto order = std::make_shared<int>(0);
  now.stop("arm", kBy);
  kept.keep(now);
  kept.served(order);
  bool saved = false;
  kept.keep_directly(order, {"arm"}, kBy, [&](bool done) { saved = done; });
  EXPECT_TRUE(kept.write());
  EXPECT_TRUE(saved);
  EXPECT_TRUE(stands("arm"));

  now.start("arm", now.newest());
  kept.keep(now);
  EXPECT_TRUE(kept.write());
  EXPECT_FALSE(stands("arm"));
}

/// Ten generations wait for a disk that is slow.
TEST_F(KeptStopsTest, AreWrittenBeforeAllThatWaitsForTheDisk) {
  auto opened = StateStore::open((dir / "state").string(), log);
  ASSERT_TRUE(opened);
  auto& store = **opened;
  const auto about = [](std::uint64_t number) {
    return Generation{
        number, "b007", kBy.time, 1000, "param.set", "why", "", "/robot", Confirmation::confirmed};
  };
  const Value robot = Value::Object{{"name", "robot"}};
  store.begin(about(1), robot);
  std::promise<void> begun;
  std::promise<void> answers;
  store.disk().post([&] {
    begun.set_value();
    answers.get_future().wait();
  });
  begun.get_future().wait();
  std::vector<std::string> order;
  for (std::uint64_t number = 2; number < 12; ++number) {
    store.keep(
        about(number), robot, {{"method", "param.set"}},
        [&](bool) { order.emplace_back("generation"); }, StateStore::As::marked, 0);
  }
  now.stop("arm", kBy);
  store.stops().keep(now, [&](bool saved) { order.emplace_back(saved ? "stop" : "lost"); });
  write_first(store);
  answers.set_value();
  store.end();

  ASSERT_EQ(order.size(), 11u);
  EXPECT_EQ(order.front(), "stop");
}

}  // namespace
}  // namespace mauve::daemon
