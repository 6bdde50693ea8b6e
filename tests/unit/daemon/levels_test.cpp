// SPDX-License-Identifier: LGPL-3.0-or-later
// The records that are logged, those that are found again, and the count of the missing ones.
#include "log/levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "log/log.h"
#include "support/eventually.h"

namespace mauve::logging {
namespace {

using namespace std::chrono_literals;

const Levels::Time kNow{1h};

TEST(Levels, AreTheUsualOneUntilSomebodyAsks) {
  Levels levels(Level::info);

  EXPECT_EQ(levels.of("arm"), Level::info);
  levels.set("arm", Level::debug);
  EXPECT_EQ(levels.of("arm"), Level::debug);
  EXPECT_EQ(levels.of("leg"), Level::info);
  levels.set("", Level::error);
  EXPECT_EQ(levels.of("arm"), Level::debug) << "its own";
  EXPECT_EQ(levels.of("leg"), Level::error);
  levels.set("arm", std::nullopt);
  levels.set("", std::nullopt);
  EXPECT_EQ(levels.of("arm"), Level::info);
  EXPECT_TRUE(levels.list().empty());
}

TEST(Levels, GoBackToWhatWasSetForGood) {
  Levels levels(Level::info);
  levels.set("arm", Level::warn);
  levels.set("arm", Level::debug, kNow + 10min);

  EXPECT_TRUE(levels.expire(kNow + 9min).empty());
  EXPECT_EQ(levels.of("arm"), Level::debug);
  ASSERT_EQ(levels.list().size(), 1U);
  EXPECT_EQ(levels.list()[0].until, kNow + 10min);

  const auto over = levels.expire(kNow + 10min);

  ASSERT_EQ(over.size(), 1U);
  EXPECT_EQ(over[0].component, "arm");
  EXPECT_EQ(over[0].level, Level::warn);
  EXPECT_EQ(levels.of("arm"), Level::warn);
  EXPECT_TRUE(levels.expire(kNow + 1h).empty()) << "reported once";
}

TEST(Levels, GoBackToTheUsualOne) {
  Levels levels(Level::info);
  levels.set("", Level::debug, kNow);
  levels.set("arm", Level::error, kNow);

  const auto over = levels.expire(kNow);

  ASSERT_EQ(over.size(), 2U);
  EXPECT_EQ(levels.of("arm"), Level::info);
  EXPECT_TRUE(levels.list().empty());
}

TEST(Levels, ThatAreSetAgainForgetTheirTime) {
  Levels levels(Level::info);
  levels.set("arm", Level::debug, kNow);
  levels.set("arm", Level::debug);

  EXPECT_TRUE(levels.expire(kNow + 1h).empty());
  EXPECT_EQ(levels.of("arm"), Level::debug);
}

Record said(const std::string& component, Level level, const std::string& text) {
  auto record = make_record(Event::core_message, {{"component", component}, {"text", text}});
  record.level = level;
  return record;
}

TEST(LogLevels, LetOneComponentSayMoreThanTheOthers) {
  Log log(Level::info);
  log.start();
  log.levels().set("arm", Level::debug);
  log.levels().set("leg", Level::error);

  log.write(said("arm", Level::debug, "a"));
  log.write(said("hip", Level::debug, "b"));
  log.write(said("leg", Level::warn, "c"));
  log.write(said("leg", Level::error, "d"));
  log.flush();

  const auto records = log.history().tail(9, {});
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].text, "a");
  EXPECT_EQ(records[1].text, "d");
}

TEST(LogLevels, AreReportedAtAnyLevelWhenTheyRevert) {
  Log log(Level::error);
  log.levels().set("arm", Level::debug, std::chrono::steady_clock::now());
  log.start();

  EXPECT_TRUE(test::eventually([&] { return !log.history().tail(1, {}).empty(); }));

  const auto records = log.history().tail(9, {});
  EXPECT_EQ(records[0].event, Event::log_level_reverted);
  EXPECT_EQ(records[0].component, "arm");
  EXPECT_EQ(records[0].text, "the log level is error again");
}

Record numbered(std::uint64_t seq, int second, const std::string& text) {
  auto record = said("arm", Level::info, text);
  record.seq = seq;
  record.time = std::chrono::system_clock::time_point(std::chrono::seconds(second));
  return record;
}

TEST(History, FindsByTimeAndText) {
  History history(10);
  history.add(numbered(1, 10, "No Fix yet"));
  history.add(numbered(2, 20, "no fix again"));
  history.add(numbered(3, 30, "fixed"));

  Filter filter;
  filter.text = "NO fix";
  EXPECT_EQ(history.tail(9, filter).size(), 2U);
  filter.since = std::chrono::system_clock::time_point(15s);
  ASSERT_EQ(history.tail(9, filter).size(), 1U);
  EXPECT_EQ(history.tail(9, filter)[0].seq, 2U);
  filter.text = "core_mess";
  EXPECT_EQ(history.tail(9, filter).size(), 2U) << "the name of the event";
  filter.text = "AR";
  EXPECT_EQ(history.tail(1, filter)[0].seq, 3U) << "the component";
  filter.text = ".*";
  EXPECT_TRUE(history.tail(9, filter).empty()) << "a text, no pattern";
}

TEST(History, CountsWhatIsMissing) {
  History history(3);
  for (std::uint64_t i = 1; i <= 4; ++i) history.add(numbered(i, static_cast<int>(i), "x"));
  auto lost = make_record(Event::events_lost, {{"count", std::int64_t{7}}, {"source", "arm"}});
  lost.component = "arm";
  lost.seq = 5;
  lost.time = std::chrono::system_clock::time_point(5s);
  history.add(lost);

  const auto since = [](int second) {
    return std::chrono::system_clock::time_point(std::chrono::seconds(second));
  };
  EXPECT_EQ(history.losses(since(0), "").gone, 2U) << "records 1 and 2";
  EXPECT_EQ(history.losses(since(3), "").gone, 0U) << "the oldest that is kept is of then";
  EXPECT_EQ(history.losses(since(0), "").lost, 7U);
  EXPECT_EQ(history.losses(since(0), "arm").lost, 7U);
  EXPECT_EQ(history.losses(since(0), "leg").lost, 0U);
  EXPECT_EQ(history.losses(since(6), "").lost, 0U);
  EXPECT_EQ(History(3).losses(since(0), "").gone, 0U);
}

TEST(Time, IsReadAsItIsWritten) {
  const auto now =
      std::chrono::system_clock::time_point(std::chrono::microseconds(1'767'261'600'123'456));
  EXPECT_EQ(time_from(utc(now)), now);
  const auto noon = time_from("2026-01-31T12:00:00Z");
  ASSERT_TRUE(noon);
  EXPECT_EQ(time_from("2026-01-31T14:30:00+02:30"), noon);
  EXPECT_EQ(time_from("2026-01-31 07:00:00.5-05:00"), *noon + 500ms);
  EXPECT_EQ(time_from("2026-01-31"), *noon - 12h);
  for (const char* bad : {"", "2026", "2026-13-01", "2026-02-30", "2026-01-31T", "2026-01-31T12:00",
                          "2026-01-31T12:00:00", "2026-01-31T24:00:00Z", "2026-01-31T12:00:00.Z",
                          "2026-01-31T12:00:00+2", "2026-01-31T12:00:00Zx", "x2026-01-31",
                          "2999-01-01", "0001-01-01"}) {
    EXPECT_FALSE(time_from(bad)) << bad;
  }
}

}  // namespace
}  // namespace mauve::logging
