// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "log/json_text.h"
#include "protocol/framing.h"
#include "support/eventually.h"
#include "support/temp_dir.h"

namespace mauve::logging {
namespace {

using test::TempDir;

/// Keeps what it gets, or fails as long as the test says so.
struct FakeSink final : Sink {
  struct Seen {
    std::mutex mutex;
    std::vector<Record> records;
    std::atomic<bool> broken{false};
    std::atomic<bool> stuck{false};
  };
  explicit FakeSink(std::shared_ptr<Seen> out) : seen(std::move(out)) {}

  Status write(const Record& record) override {
    while (seen->stuck) {
      std::this_thread::yield();
    }
    if (seen->broken) {
      return refuse(Errc::system, "the disk", "no space left");
    }
    const std::lock_guard lock(seen->mutex);
    seen->records.push_back(record);
    return ok();
  }

  std::shared_ptr<Seen> seen;
};

TEST(Events, HaveUniqueNumbersNamesAndAnAdvice) {
  std::set<std::string> ids;
  std::set<std::string_view> names;
  for (const auto& event : all_events()) {
    EXPECT_TRUE(ids.insert(message_id(event.event)).second) << event.name;
    EXPECT_TRUE(names.insert(event.name).second) << event.name;
    EXPECT_GT(event.advice.size(), 10U) << event.name;
    EXPECT_EQ(message_id(event.event).size(), 32U);
  }
}

TEST(Record, SaysItsFieldsInOneSentence) {
  const auto record = make_record(Event::missed, {{"component", std::string("arm")},
                                                  {"text", std::string("3 releases missed")}});

  EXPECT_EQ(record.text, "3 releases missed");
  EXPECT_EQ(record.component, "arm");
  EXPECT_EQ(record.level, Level::warn);
  ASSERT_EQ(record.fields.size(), 1U);
}

TEST(Record, KeepsAPlaceholderWithoutAField) {
  EXPECT_EQ(make_record(Event::listening, {}).text, "listening on {socket}");
}

TEST(Record, IsOneLineOfJson) {
  auto record = make_record(Event::component_faulted, {{"component", std::string("arm")},
                                                       {"text", std::string("a \"b\"\n\x01\xff")},
                                                       {"x", 1.5},
                                                       {"nan", std::nan("")}});
  record.seq = 7;

  const auto line = to_json_line(record);

  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto json = protocol::parse_json(line);
  ASSERT_TRUE(json) << line;
  EXPECT_EQ((*json)["seq"], 7);
  EXPECT_EQ((*json)["event"], "component_faulted");
  EXPECT_EQ((*json)["level"], "error");
  EXPECT_EQ((*json)["fields"]["text"], "a \"b\"\n\x01\xEF\xBF\xBD");
  EXPECT_EQ((*json)["fields"]["x"], 1.5);
  EXPECT_EQ((*json)["fields"]["nan"], "nan");
}

TEST(JsonText, KeepsWhatIsUtf8AndReplacesWhatIsNot) {
  EXPECT_EQ(json_string("\xC3\xA4 \xE2\x82\xAC \xF0\x9F\xA4\x96"),
            "\"\xC3\xA4 \xE2\x82\xAC \xF0\x9F\xA4\x96\"");
  for (const auto* bad : {"\x80", "\xC0\xAF", "\xE2\x82", "\xED\xA0\x80", "\xF4\x90\x80\x80"}) {
    EXPECT_THAT(json_string(bad), testing::HasSubstr("\xEF\xBF\xBD"));
    EXPECT_TRUE(protocol::parse_json(json_string(bad)));
  }
}

TEST(Printable, IsOneLineThatNoTerminalObeys) {
  EXPECT_EQ(printable("a\n2026-01-01 error forged\x1B[31m\x7F"),
            "a\\n2026-01-01 error forged\\u001b[31m\\u007f");
  EXPECT_EQ(printable("\xC2\x9B"  // CSI in one character
                      "\u202E\u2066\u2028"),
            "\\xc2\\x9b\\xe2\\x80\\xae\\xe2\\x81\\xa6\\xe2\\x80\\xa8");
  EXPECT_EQ(json_string("\u202Egnp.exe\xC2\x9B\x7F"), R"("\u202egnp.exe\u009b\u007f")");
  EXPECT_EQ(printable("\x80"), "\xEF\xBF\xBD");
  EXPECT_EQ(printable("3 \u00B5s, \u201Cgain\u201D, \u2020, \u206A \\n"),
            "3 \u00B5s, \u201Cgain\u201D, \u2020, \u206A \\n")
      << "everything else stays as it is";
}

TEST(Record, StatesTheTimeInUtc) {
  EXPECT_EQ(utc(std::chrono::system_clock::time_point(std::chrono::microseconds(1'500'000))),
            "1970-01-01T00:00:01.500000Z");
}

class LogTest : public testing::Test {
 protected:
  void SetUp() override {
    log.add_sink(std::make_unique<FakeSink>(seen));
    log.start();
  }
  std::vector<std::string> texts() {
    log.flush();
    const std::lock_guard lock(seen->mutex);
    std::vector<std::string> out;
    for (const auto& record : seen->records) {
      out.push_back(record.text);
    }
    return out;
  }

  std::shared_ptr<FakeSink::Seen> seen = std::make_shared<FakeSink::Seen>();
  Log log{Level::info, 4};
};

constexpr const char* kPaused = "no descriptor left: new clients may only stop, confirm and undo";
constexpr const char* kResumed = "new clients may do all again";

TEST_F(LogTest, WritesEventsInOrderWithoutGaps) {
  log.write(Event::accept_paused);
  log.write(Event::accept_resumed);

  EXPECT_THAT(texts(), testing::ElementsAre(kPaused, kResumed));
  EXPECT_EQ(seen->records[0].seq, 1U);
  EXPECT_EQ(seen->records[1].seq, 2U);
}

TEST_F(LogTest, LeavesOutWhatIsBelowItsLevel) {
  log.write(Event::client_gone, {});
  EXPECT_THAT(texts(), testing::IsEmpty());

  log.levels().set({}, Level::debug);
  log.write(Event::client_gone, {});
  EXPECT_EQ(texts().size(), 1U);
}

TEST_F(LogTest, MergesTheSourceByTime) {
  auto earlier = make_record(Event::missed, {{"text", std::string("earlier")}});
  std::atomic<bool> empty{false};
  log.write(Event::missed, {{"text", std::string("later")}});
  log.set_source([&](const auto& take) {
    if (!empty.exchange(true)) {
      take(earlier);
    }
  });

  const auto all = texts();

  EXPECT_THAT(all, testing::UnorderedElementsAre("earlier", "later"));
  const auto tail = log.history().tail(2, {});
  ASSERT_EQ(tail.size(), 2U);
  EXPECT_EQ(tail[0].text, "earlier") << "in whichever round it came";
  log.set_source({});
}

TEST_F(LogTest, HoldsARecordOfARingBackThatIsYoungerThanOneInTheQueue) {
  std::atomic<bool> empty{false};
  log.set_source([&](const auto& take) {
    if (!empty.exchange(true)) {
      log.write(Event::missed, {{"text", std::string("older")}});
      take(make_record(Event::missed, {{"text", std::string("younger")}}));
    }
  });

  EXPECT_THAT(texts(), testing::ElementsAre("older", "younger"));
  log.set_source({});
}

TEST_F(LogTest, StampsARecordWhenItJoinsTheQueue) {
  const auto before = make_record(Event::accept_paused, {});
  log.write(Event::accept_resumed);
  log.write(before);

  EXPECT_THAT(texts(), testing::ElementsAre(kResumed, kPaused));
  EXPECT_LT(seen->records[0].monotonic_ns, seen->records[1].monotonic_ns);
}

TEST_F(LogTest, KeepsTheLastRecordsForTheTail) {
  for (int i = 0; i < 10; ++i) {
    log.write(Event::listening, {{"socket", std::to_string(i)}});
  }
  log.flush();

  const auto tail = log.history().tail(3, {});

  ASSERT_EQ(tail.size(), 3U);
  EXPECT_EQ(tail[0].seq, 8U);
  EXPECT_EQ(tail[2].text, "listening on 9");
  EXPECT_EQ(log.history().tail(100, {}).size(), 4U);
}

TEST_F(LogTest, FiltersTheTailByLevelAndComponent) {
  log.write(Event::missed, {{"component", std::string("arm")}});
  log.write(Event::missed, {{"component", std::string("leg")}});
  log.write(Event::component_started, {{"component", std::string("arm")}});
  log.flush();

  EXPECT_EQ(log.history().tail(10, {Level::warn, "arm"}).size(), 1U);
  EXPECT_EQ(log.history().tail(10, {Level::warn, ""}).size(), 2U);
  EXPECT_EQ(log.history().tail(10, {Level::debug, "arm"}).size(), 2U);
}

TEST_F(LogTest, GivesFollowersWhatIsKeptAndThenEveryNewRecord) {
  log.write(Event::listening, {{"socket", std::string("a")}});
  log.flush();
  std::vector<std::string> followed;
  const auto following =
      log.history().follow(10, {}, [&](const Record& record) { followed.push_back(record.text); });
  log.write(Event::listening, {{"socket", std::string("b")}});
  log.flush();

  log.history().unfollow(following.id);
  log.write(Event::listening, {{"socket", std::string("c")}});
  log.flush();

  ASSERT_EQ(following.kept.size(), 1U);
  EXPECT_EQ(following.kept[0].text, "listening on a");
  EXPECT_THAT(followed, testing::ElementsAre("listening on b"));
}

TEST_F(LogTest, HoldsNoWriterUpWhileAFollowerIsNotified) {
  std::size_t found = 0;
  const auto following = log.history().follow(0, {}, [&](const Record& /*record*/) {
    found = log.history().tail(10, {}).size();  // of another thread it would wait likewise
  });
  log.write(Event::listening, {{"socket", std::string("a")}});
  log.flush();
  log.history().unfollow(following.id);

  EXPECT_EQ(found, 1U);
}

TEST_F(LogTest, NeverWaitsForASinkAndCountsWhatIsLost) {
  seen->stuck = true;
  for (std::size_t i = 0; i < 3 * Log::kQueue; ++i) {
    log.write(Event::accept_paused);
  }
  seen->stuck = false;
  log.flush();

  const auto all = texts();
  const auto lost = std::find_if(all.begin(), all.end(), [](const std::string& text) {
    return text.find("events of the daemon were lost") != std::string::npos;
  });
  EXPECT_NE(lost, all.end());
}

TEST_F(LogTest, ComplainsOnceAboutABrokenSinkAndGoesOn) {
  seen->broken = true;
  log.write(Event::accept_paused);
  log.write(Event::accept_paused);
  log.flush();
  EXPECT_EQ(log.history().tail(10, {Level::error, ""}).size(), 1U);

  EXPECT_EQ(log.unwritten(), 2U);

  seen->broken = false;
  log.write(Event::accept_resumed);
  EXPECT_THAT(texts(),
              testing::ElementsAre(testing::_,
                                   "the disk takes the log again; 2 records are missing in it"));
}

TEST_F(LogTest, WritesEverythingBeforeItStops) {
  for (int i = 0; i < 100; ++i) {
    log.write(Event::accept_paused);
  }
  log.stop();

  EXPECT_EQ(seen->records.size(), 100U);
}

}  // namespace
}  // namespace mauve::logging
