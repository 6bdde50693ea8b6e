// SPDX-License-Identifier: LGPL-3.0-or-later
/// The time that the drivers of serial lines need for their bytes, and the worst line for them.
#include <chrono>
#include <cstdlib>
#include <string>

#include "../../plugins/drivers/gnss/gnss_reader.h"
#include "../../plugins/drivers/gnss/nmea_write.h"
#include "../../plugins/drivers/gnss/ubx_pvt.h"
#include "../../plugins/drivers/imu/xbus_frame.h"
#include "../../plugins/drivers/imu/xbus_imu.h"
#include "bench/support/report.h"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kJob = 16 * 1024;  // bytes that a job reads at most

/// Repeated until it is `size` bytes long.
std::string filled(const std::string& pattern, std::size_t size) {
  std::string bytes;
  while (bytes.size() < size) bytes += pattern;
  bytes.resize(size);
  return bytes;
}

struct Receiver {
  drivers::GnssStream stream;
  drivers::GnssReader reader;

  void use(drivers::GnssStream::Event found) { (void)reader.read(found, stream, 0.0, 100.0); }
};

struct Unit {
  drivers::XbusStream stream;
  drivers::ImuReader reader;

  void use(drivers::XbusStream::Event found) {
    if (found == drivers::XbusStream::Event::frame) (void)reader.read(stream.frame(), 0.0);
  }
};

/// Microseconds to read all of it.
template <typename Line>
double microseconds(const std::string& bytes) {
  using Event = decltype(Line{}.stream.next());
  Line line;
  const auto begin = Clock::now();
  for (const char byte : bytes) {
    line.stream.push(byte);
    for (Event found = line.stream.next(); found != Event::none; found = line.stream.next()) {
      line.use(found);
    }
  }
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

template <typename Frame>
std::string text(const Frame& frame) {
  return {frame.begin(), frame.end()};
}

void run(const Options& options) {
  const rover::GnssFix fix{3661.0, 43.5, 1.5, 150.0, 0.9, 3, 9};
  drivers::NmeaWriter sentences;
  drivers::ImuWriter measurements;
  const std::size_t size = static_cast<std::size_t>(options.choose(64, 1)) * kJob;
  const std::string nmea = filled(std::string(sentences.compose(fix, 0.0, 0.0)), size);
  const std::string ubx = filled(text(drivers::write_pvt(fix)), size);
  const std::string xbus = filled(text(measurements.compose({}, 1)), size);
  // Frames that begin every few bytes, promise the greatest length, and are damaged.
  const std::string ubx_worst = filled(std::string("\xb5\x62\xf8\x03\xf8\x03", 6), kJob);
  const std::string xbus_worst = filled(std::string("\xfa\xff\x36\xfe", 4), kJob);

  Report report("lines", "Serial lines of drivers/gnss and drivers/imu: bytes to published values.",
                options);
  Figure& a = report.figure("NMEA", "MB/s");
  Figure& b = report.figure("UBX", "MB/s");
  Figure& c = report.figure("Xbus", "MB/s");
  Figure& d = report.figure("16 KiB, all that a job reads, of the worst UBX", "us");
  Figure& e = report.figure("16 KiB of the worst Xbus", "us");
  const auto bytes = static_cast<double>(size);
  for (int round = 0; round < options.rounds; ++round) {
    a.add(bytes / microseconds<Receiver>(nmea));
    b.add(bytes / microseconds<Receiver>(ubx));
    c.add(bytes / microseconds<Unit>(xbus));
    d.add(microseconds<Receiver>(ubx_worst));
    e.add(microseconds<Unit>(xbus_worst));
  }
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  bench::run(bench::parse(argc, argv));
  return EXIT_SUCCESS;
}
