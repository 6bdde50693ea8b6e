// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes from an inertial unit: every measurement that comes out has finite numbers, and after
// all of it good frames are found again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "../../plugins/drivers/imu/xbus_frame.h"
#include "../../plugins/drivers/imu/xbus_imu.h"

namespace {

using drivers::ImuReader;
using drivers::XbusStream;

void require(bool condition) {
  if (!condition) std::abort();
}

struct Line {
  XbusStream stream;
  ImuReader reader;
  std::size_t measurements = 0;

  void look(double now) {
    for (auto found = stream.next(); found != XbusStream::Event::none; found = stream.next()) {
      if (found == XbusStream::Event::bad) continue;
      if (reader.read(stream.frame(), now) != ImuReader::Event::imu) continue;
      ++measurements;
      const rover::Imu& imu = reader.imu();
      require(std::isfinite(imu.time) && std::isfinite(imu.yaw_rate));
      require(std::isfinite(imu.acceleration_x) && std::isfinite(imu.acceleration_y));
      require(std::abs(imu.heading) <= 3.15);
    }
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Line line;
  for (std::size_t i = 0; i < size; ++i) {
    line.stream.push(static_cast<char>(data[i]));
    line.look(0.0001 * static_cast<double>(i));
  }
  line.stream.drop_begun();
  line.look(10.0);
  require(!line.stream.in_frame());
  const std::size_t before = line.measurements;
  drivers::ImuWriter writer;
  for (const std::uint8_t byte : writer.compose({0.0, 0.1, 0.0, 0.0, 0.5, true}, 7)) {
    line.stream.push(static_cast<char>(byte));
    line.look(10.0);
  }
  require(line.measurements == before + 1);
  return 0;
}
