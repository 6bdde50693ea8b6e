// SPDX-License-Identifier: LGPL-3.0-or-later
#include "device_line.h"

namespace drivers {
namespace {

/// Some fifty commands, a second of them: a device that hung shall not hear older ones later.
constexpr std::size_t kMostWaiting = 256;

}  // namespace

mauve::Status DeviceLine::open(const std::string& device, int baud, SerialPort::Use use) {
  heard_ = mauve::job_time();
  if (mauve::Status opened = port_.open(device, baud, SerialPort::Missing::accepted, use);
      !opened) {
    return opened;
  }
  lost_ = !port_.is_open();
  if (lost_) ++errors_;
  thread_.when_received([this](std::size_t count) { received_ += count; });
  return thread_.start(port_, kMostWaiting);
}

void DeviceLine::close(LineBytes& line) {
  thread_.stop();
  port_.close();
  thread_.empty_handed(line);
}

bool DeviceLine::reopen() {
  heard_ = mauve::job_time();
  lost_ = !thread_.reopen();
  report();
  if (lost_) return false;
  ++reopened_;
  return true;
}

bool DeviceLine::take(LineBytes& line, char& byte) {
  begin_job(line);
  if (lost_ || bytes_left_ == 0) return false;
  const bool open = thread_.open();
  const std::span<const char> there = line.ring.there();
  if (there.empty()) {
    lost_ = !open;
    if (lost_) ++errors_;
    report();
    return false;
  }
  byte = there.front();
  line.ring.drop(1);
  --bytes_left_;
  heard_ = job_;
  return true;
}

void DeviceLine::report() {
  there_.report(!lost_, "its device is back", "its device is not there (time {})", errors_.get());
}

void DeviceLine::count_damaged(Counter& bad_frames) {
  if (rover::worth_reporting(++bad_frames)) {
    mauve::log(mauve::LogLevel::warning, "{} damaged frames so far", bad_frames.get());
  }
}

mauve::Duration DeviceLine::silence() const { return mauve::Duration{mauve::job_time() - heard_}; }

/// A device that never runs dry must not hold up the job: so many bytes, then the rest waits.
void DeviceLine::begin_job(LineBytes& line) {
  if (const mauve::Instant now = mauve::job_time(); now != job_) {
    job_ = now;
    bytes_left_ = kBytesPerJob;
    thread_.fill(line);
  }
}

}  // namespace drivers
