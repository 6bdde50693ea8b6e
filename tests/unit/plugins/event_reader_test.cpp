// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "../../../plugins/teleop/input_device.h"
#include "support/input_events.h"
#include "support/temp_dir.h"

namespace {

using mauve::test::InputEvents;
using mauve::test::TempDir;
using teleop::EventReader;
using teleop::InputDevice;
using teleop::Mark;
using namespace std::chrono_literals;  // NOLINT: durations

constexpr std::int32_t kLowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kHighest = std::numeric_limits<std::int32_t>::max();

class EventReading : public testing::Test {
 protected:
  EventReading() { reader_.begin(); }

  std::size_t push(const InputEvents& events) {
    return reader_.push({events.bytes().data(), events.bytes().size()});
  }
  [[nodiscard]] float axis(std::size_t index) const { return reader_.shown().axes[index]; }

  EventReader reader_;
};

TEST_F(EventReading, CountsForwardAndLeftAsPositive) {
  push(InputEvents().axis(ABS_X, 32767).axis(ABS_Y, -32767).report());

  EXPECT_FLOAT_EQ(axis(0), -1.0F);
  EXPECT_FLOAT_EQ(axis(1), 1.0F);
}

TEST_F(EventReading, ShowsAReportOnlyWhenItIsComplete) {
  EXPECT_EQ(push(InputEvents().axis(ABS_Y, -32767).key(BTN_SOUTH, 1)), 0U);
  EXPECT_FLOAT_EQ(axis(1), 0.0F);

  EXPECT_EQ(push(InputEvents().report()), 1U);
  EXPECT_FLOAT_EQ(axis(1), 1.0F);
  EXPECT_EQ(reader_.shown().buttons, 1);
}

TEST_F(EventReading, KeepsAnEventCutAnywhere) {
  const InputEvents events = InputEvents().axis(ABS_X, -32767).key(BTN_TRIGGER, 1).report();
  for (std::size_t piece = 1; piece < events.bytes().size(); ++piece) {
    reader_.begin();
    std::span<const char> rest(events.bytes().data(), events.bytes().size());
    while (!rest.empty()) {
      const std::size_t size = std::min(piece, rest.size());
      reader_.push(rest.first(size));
      rest = rest.subspan(size);
    }
    EXPECT_FLOAT_EQ(axis(0), 1.0F) << piece;
    EXPECT_EQ(reader_.shown().buttons, 1) << piece;
  }
}

TEST_F(EventReading, NumbersButtonsOfSticksAndGamepads) {
  push(InputEvents().key(BTN_THUMB, 1).key(BTN_TL, 1).key(BTN_TRIGGER_HAPPY2, 1).report());

  EXPECT_EQ(reader_.shown().buttons, (1 << 1) | (1 << 6) | (1 << 17));

  push(InputEvents().key(BTN_TL, 2).key(BTN_THUMB, 0).key(KEY_A, 1).report());
  EXPECT_EQ(reader_.shown().buttons, (1 << 6) | (1 << 17));
}

TEST_F(EventReading, EndsWellOnAbsurdRangesAndValues) {
  reader_.set_range(0, {5, 5});
  reader_.set_range(1, {100, -100});
  reader_.set_range(2, {kLowest, kHighest});
  reader_.set_range(3, {0, 1});
  push(InputEvents()
           .axis(ABS_X, kHighest)
           .axis(ABS_Y, kLowest)
           .axis(ABS_Z, kLowest)
           .axis(ABS_RX, kLowest)
           .report());

  EXPECT_FLOAT_EQ(axis(0), 0.0F);
  EXPECT_FLOAT_EQ(axis(1), 0.0F);
  EXPECT_FLOAT_EQ(axis(2), 1.0F);
  EXPECT_FLOAT_EQ(axis(3), 1.0F);
}

TEST_F(EventReading, LetsGoWhenTheKernelDroppedEvents) {
  push(InputEvents().axis(ABS_Y, -32767).key(BTN_SOUTH, 1).report());
  EXPECT_TRUE(reader_.holds());

  EXPECT_EQ(push(InputEvents().dropped().axis(ABS_Y, -20000)), 1U);
  EXPECT_TRUE(reader_.take_dropped()) << "at once: nothing may follow";
  EXPECT_FALSE(reader_.take_dropped());
  EXPECT_FALSE(reader_.holds());
  EXPECT_FLOAT_EQ(axis(1), 0.0F);
  EXPECT_EQ(reader_.shown().buttons, 0);

  EXPECT_EQ(push(InputEvents().report()), 0U) << "the rest of what was dropped";
  EXPECT_FALSE(reader_.holds());
  EXPECT_EQ(push(InputEvents().axis(ABS_Y, -32767).report()), 1U);
  EXPECT_TRUE(reader_.holds());
}

class InputDevices : public testing::Test {
 protected:
  void choose(const std::string& path) {
    device_.choose(path, 1h);
    opened_ = device_.reopen();
  }
  /// The events that came, as type and code; "lost".
  std::string read() {
    std::string all;
    std::array<char, 100> bytes{};  // no multiple of an event
    for (;;) {
      const auto count = device_.read(bytes);
      if (count < 0) return "lost";
      if (count == 0) break;
      all.append(bytes.data(), static_cast<std::size_t>(count));
    }
    std::string said;
    for (std::size_t at = 0; at < all.size(); at += sizeof(input_event)) {
      input_event event;
      std::memcpy(&event, all.data() + at, sizeof event);
      said += event.type == Mark::kType ? event.code == Mark::kThere ? "there " : "gone "
                                        : std::to_string(event.type) + " ";
    }
    return said;
  }

  TempDir place_;
  InputDevice device_;
  bool opened_ = false;
};

TEST_F(InputDevices, DistinguishesAFifoWithoutWriterFromASilentOne) {
  const std::string path = (place_.path() / "events").string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  choose(path);
  ASSERT_TRUE(opened_);
  EXPECT_EQ(read(), "");

  std::ofstream writer(path, std::ios::binary);
  EXPECT_EQ(read(), "there ");
  EXPECT_EQ(read(), "");
  writer << InputEvents().axis(ABS_X, 1).report().bytes() << std::flush;
  EXPECT_EQ(read(), "3 0 ");
  writer.close();
  EXPECT_EQ(read(), "gone ");
  EXPECT_EQ(read(), "");
}

TEST_F(InputDevices, HandsOnWholeEventsAndNoneThatOnlyItselfMaySay) {
  const std::string path = (place_.path() / "events").string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  choose(path);
  std::ofstream writer(path, std::ios::binary);
  input_event forged{};
  forged.type = Mark::kType;
  forged.code = Mark::kGone;
  const std::string bytes = InputEvents().key(BTN_SOUTH, 1).report().bytes();
  writer.write(reinterpret_cast<const char*>(&forged), sizeof forged);
  writer << bytes.substr(0, 30) << std::flush;
  EXPECT_EQ(read(), "there 1 ");
  writer << bytes.substr(30) << bytes.substr(0, 5) << std::flush;
  EXPECT_EQ(read(), "0 ");
  writer.close();
  EXPECT_EQ(read(), "gone ");

  writer.open(path, std::ios::binary);
  writer << bytes << std::flush;
  EXPECT_EQ(read(), "there 1 0 ") << "half an event of the one before is no part of it";
}

TEST_F(InputDevices, LosesATerminalThatHangsUp) {
  mauve::serial::PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  choose(line.device());
  ASSERT_TRUE(opened_);
  EXPECT_EQ(read(), "there ");

  line.close();
  EXPECT_EQ(read(), "lost");
}

TEST_F(InputDevices, ReadsAFileOnce) {
  const std::string bytes = InputEvents().key(BTN_SOUTH, 1).report().bytes();
  device_.choose(place_.write("events", bytes).string(), 0ns);
  ASSERT_TRUE(device_.reopen());

  EXPECT_EQ(read(), "there 1 0 gone ");
  EXPECT_EQ(read(), "");
}

TEST_F(InputDevices, CannotOpenWhatIsNotThere) {
  choose((place_.path() / "nothing").string());

  EXPECT_FALSE(opened_);
  EXPECT_EQ(device_.number(), -1);
}

TEST_F(InputDevices, FindsAFifoThatIsMadeAnewAndLosesOneThatIsNoMore) {
  const std::string path = (place_.path() / "events").string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  device_.choose(path, 0ns);  // looked for whenever it is read
  ASSERT_TRUE(device_.reopen());
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(read(), "");
  std::ofstream writer(path, std::ios::binary);
  EXPECT_EQ(read(), "there ");
  writer.close();
  EXPECT_EQ(read(), "gone ");

  std::filesystem::remove(path);
  EXPECT_EQ(read(), "lost");
}

}  // namespace
