// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes from a receiver: no epoch that comes out has a position that cannot be, and after all
// of it good frames are found again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "../../plugins/drivers/gnss/gnss_reader.h"
#include "../../plugins/drivers/gnss/ubx_pvt.h"

namespace {

using drivers::GnssReader;
using drivers::GnssStream;

void require(bool condition) {
  if (!condition) std::abort();
}

struct Line {
  GnssStream stream;
  GnssReader reader;
  std::size_t fixes = 0;
  std::size_t messages = 0;

  void look(double now) {
    take(reader.overdue(now, 100.0));
    for (auto found = stream.next(); found != GnssStream::Event::none; found = stream.next()) {
      messages += found == GnssStream::Event::message ? 1U : 0U;
      do {
        take(reader.read(found, stream, now, 100.0));
      } while (reader.unread());
    }
  }

  void take(GnssReader::Event event) {
    if (event != GnssReader::Event::fix) return;
    ++fixes;
    const rover::GnssFix& fix = reader.fix();
    require(std::abs(fix.latitude) <= 90.0 && std::abs(fix.longitude) <= 180.0);
    require(fix.time >= 0.0 && fix.time < 86'402.0 && std::isfinite(fix.altitude));
    require(fix.mode >= 1 && fix.mode <= 3 && fix.satellites >= 0);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Line line;
  for (std::size_t i = 0; i < size; ++i) {
    line.stream.push(static_cast<char>(data[i]));
    line.look(0.01 * static_cast<double>(i));
  }
  line.stream.drop_begun();
  line.look(1e6);
  require(!line.stream.in_frame());
  const std::size_t before = line.messages;
  for (const std::uint8_t byte : drivers::write_pvt({1.0, 1.0, 1.0, 1.0, 1.0, 3, 4})) {
    line.stream.push(static_cast<char>(byte));
    line.look(1e6);
  }
  require(line.messages == before + 1);
  return 0;
}
