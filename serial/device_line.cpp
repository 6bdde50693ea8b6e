// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/device_line.h>

#include <cerrno>
#include <utility>

#include <mauve/log.h>

namespace mauve::serial {
namespace {

/// Some fifty commands, a second of them: a device that hung shall not hear older ones later.
constexpr std::size_t kMostWaiting = 256;

}  // namespace

DeviceLine::DeviceLine(mauve::Configurable& core, LineSettings settings)
    : device(core, "device", std::move(settings.device),
             "serial device, or pty:NAME of a simulated one", {.within = "/dev/ pty:"}),
      baud(core, "baud", settings.baud, "speed of the line; 0 leaves it alone, as for USB",
           {.unit = "1/s", .min = 0, .max = 921'600}),
      device_errors(core, "device_errors", 0, "times it was not there or went away"),
      reopened(core, "reopened", 0, "times it came, or came back"),
      received(core, "received", 0, "bytes"),
      unsent(core, "unsent", 0, "commands that found no room"),
      unplugged(core, "unplugged", "its device is not there"),
      takes_no_bytes(core, "takes_no_bytes", "its device does not take the commands"),
      core_(core),
      use_(settings.use) {}

mauve::Status DeviceLine::open() {
  heard_ = mauve::job_time();
  port_.belongs_to(core_.address());
  if (mauve::Status opened = port_.open(device, baud, SerialPort::Missing::accepted, use_);
      !opened) {
    return opened;
  }
  lost_ = !port_.is_open();
  if (lost_) ++device_errors;
  thread_.when_received([this](std::size_t count) { received += count; });
  losses_ = 0;
  using Lost = LineThread::Lost;
  const std::size_t most_waiting = use_ == SerialPort::Use::both ? kMostWaiting : 0;
  return thread_.start(port_, most_waiting, port_.is_guarded() ? Lost::looked_for : Lost::waits);
}

void DeviceLine::close(LineBytes& line) {
  thread_.stop();
  port_.close();
  thread_.empty_handed(line);
}

bool DeviceLine::reopen() {
  heard_ = mauve::job_time();
  losses_ = thread_.losses();
  lost_ = !thread_.reopen();
  report();
  if (lost_) return false;
  ++reopened;
  return true;
}

bool DeviceLine::take(LineBytes& line, char& byte) {
  begin_job(line);
  if (lost_ || bytes_left_ == 0) return false;
  const bool open = thread_.open() && thread_.losses() == losses_;
  const std::span<const char> there = line.ring.there();
  if (there.empty()) {
    lost_ = !open;
    if (lost_) ++device_errors;
    report();
    return false;
  }
  byte = there.front();
  line.ring.drop(1);
  --bytes_left_;
  heard_ = job_;
  return true;
}

void DeviceLine::forget(LineBytes& line) {
  begin_job(line);
  for (int part = 0; part < 2; ++part) line.ring.drop(line.ring.there().size());
}

bool DeviceLine::send(std::string_view bytes) {
  if (lost_ || mauve::is_abandoned()) return false;
  if (thread_.send(bytes)) {
    takes_no_bytes.end("its device takes bytes again");
    return true;
  }
  ++unsent;
  takes_no_bytes.begin("its device takes no bytes, so commands are lost ({} so far)", unsent.get());
  return false;
}

/// The log has a line for each change, also of the core: a swap continues the warning.
void DeviceLine::report() {
  if (lost_ && thread_.error() == EBUSY) {
    unplugged.begin("its device belongs to another process (time {})", device_errors.get());
  } else if (lost_ && thread_.error() == kOfAnotherComponent) {
    unplugged.begin("its device is that of another component, under another name (time {})",
                    device_errors.get());
  } else if (lost_ && thread_.error() == kNotGuarded) {
    unplugged.begin("its device is there, but no guardian holds its order (time {})",
                    device_errors.get());
  } else if (lost_) {
    unplugged.begin("its device is not there (time {})", device_errors.get());
  } else {
    unplugged.end("its device is back");
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

}  // namespace mauve::serial
