// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes are the stream of a Create 2, and its input. Every report that is believed stands in
// the stream as a whole frame, and the odometry stays a number.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "../../plugins/drivers/base/create_oi.h"
#include "../../plugins/drivers/base/wheels.h"

namespace {

namespace create = drivers::create;
using Event = create::ReportReader::Event;

void require(bool condition) {
  if (!condition) std::abort();
}

/// An undamaged frame of the Open Interface ends these bytes.
bool frame_ends(std::string_view stream) {
  unsigned sum = 0;
  for (std::size_t length = 1; length <= stream.size() && length <= create::kMostData + 3;
       ++length) {
    const std::string_view frame = stream.substr(stream.size() - length);
    sum += static_cast<std::uint8_t>(frame[0]);
    if (length < create::kFrame || frame[0] != 19 || sum % 256U != 0) continue;
    if (static_cast<std::uint8_t>(frame[1]) + 3U == length) return true;
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view stream(reinterpret_cast<const char*>(data), size);
  create::ReportReader reader;
  create::CommandReader commands;
  const drivers::Wheels wheels;
  drivers::WheelOdometry odometry;
  std::size_t reports = 0;
  std::size_t others = 0;
  std::size_t bad = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (const auto command = commands.push(stream[i])) {
      const auto text = create::drive_text(command->left, command->right);
      require(static_cast<create::Opcode>(static_cast<std::uint8_t>(text[0])) ==
              create::Opcode::drive_direct);
    }
    reader.push(stream[i]);
    bool reported = false;
    for (auto event = reader.next(); event != Event::none; event = reader.next()) {
      bad += event == Event::bad ? 1 : 0;
      others += event == Event::lacking ? 1 : 0;
      reported = reported || event == Event::report;
    }
    if (!reported) continue;
    ++reports;
    require(frame_ends(stream.substr(0, i + 1)));
    odometry.advance(reader.report().left, reader.report().right,
                     create::kStreamPeriod * static_cast<double>(1 + bad % 1000), wheels);
    const rover::Odometry& now = odometry.odometry();
    require(std::isfinite(now.x) && std::isfinite(now.y) && std::abs(now.heading) <= 3.15);
    require(std::isfinite(now.linear) && std::isfinite(now.angular));
  }
  require(reports * create::kFrame <= size);
  require(bad <= size / create::kFrame + reports + others + 1);
  return 0;
}
