// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
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
  push(InputEvents().dropped().axis(ABS_Y, -20000));
  EXPECT_FALSE(reader_.take_dropped());

  EXPECT_EQ(push(InputEvents().report()), 1U);
  EXPECT_TRUE(reader_.take_dropped());
  EXPECT_FALSE(reader_.take_dropped());
  EXPECT_FLOAT_EQ(axis(1), 0.0F);
  EXPECT_EQ(reader_.shown().buttons, 0);
}

class InputDevices : public testing::Test {
 protected:
  InputDevice::Got read() {
    std::array<char, 256> bytes{};
    return device_.read(bytes, count_);
  }

  TempDir place_;
  InputDevice device_;
  std::size_t count_ = 0;
};

TEST_F(InputDevices, TellsAFifoThatNobodyWritesToFromOneThatIsSilent) {
  const std::string path = (place_.path() / "events").string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  device_.name(path);
  ASSERT_TRUE(device_.open());
  EXPECT_EQ(read(), InputDevice::Got::nobody);

  std::ofstream writer(path, std::ios::binary);
  EXPECT_EQ(read(), InputDevice::Got::nothing);
  writer << InputEvents().report().bytes() << std::flush;
  EXPECT_EQ(read(), InputDevice::Got::bytes);
  EXPECT_EQ(count_, sizeof(input_event));
  writer.close();
  EXPECT_EQ(read(), InputDevice::Got::nobody);
}

TEST_F(InputDevices, LosesATerminalThatHangsUp) {
  drivers::PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  device_.name(line.device());
  ASSERT_TRUE(device_.open());
  EXPECT_EQ(read(), InputDevice::Got::nothing);

  line.close();
  EXPECT_EQ(read(), InputDevice::Got::lost);
}

TEST_F(InputDevices, LeavesTheReaderAloneWhenItIsNoInputDevice) {
  device_.name(place_.write("events", "").string());
  ASSERT_TRUE(device_.open());
  EXPECT_TRUE(device_.is_file());
  EventReader reader;
  reader.begin();
  const InputEvents events = InputEvents().key(BTN_SOUTH, 1).report();
  reader.push({events.bytes().data(), events.bytes().size()});

  EXPECT_FALSE(device_.ask(reader));
  EXPECT_EQ(reader.shown().buttons, 1);
}

TEST_F(InputDevices, CannotOpenWhatIsNotThere) {
  device_.name((place_.path() / "nothing").string());

  EXPECT_FALSE(device_.open());
  EXPECT_FALSE(device_.is_open());
}

}  // namespace
