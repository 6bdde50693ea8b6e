// SPDX-License-Identifier: LGPL-3.0-or-later
#include "line_reader.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

mauve::Status LineReader::start(const std::string& device) {
  if (mauve::Status opened = open(device); !opened) {
    stop();
    return opened;
  }
  wake_ = eventfd(0, EFD_CLOEXEC);
  online_ = true;
  thread_ = std::thread([this] { run(); });
  return mauve::ok();
}

mauve::Status LineReader::open(const std::string& device) {
  device_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (device_ < 0) {
    return mauve::refuse(mauve::Errc::system, device, std::strerror(errno), "is it plugged in?");
  }
  // Two readers of one line would each get a part of the bytes.
  if (flock(device_, LOCK_EX | LOCK_NB) != 0) {
    return mauve::refuse(mauve::Errc::wrong_state, device, "another driver has opened it",
                         "exchange the core with --in-place");
  }
  termios line{};
  if (tcgetattr(device_, &line) != 0) {
    return mauve::refuse(mauve::Errc::invalid_value, device, "is no terminal");
  }
  cfmakeraw(&line);
  cfsetspeed(&line, B9600);
  tcsetattr(device_, TCSANOW, &line);
  return mauve::ok();
}

void LineReader::stop() {
  if (thread_.joinable()) {
    eventfd_write(wake_, 1);
    thread_.join();
  }
  for (int* descriptor : {&device_, &wake_}) {
    if (*descriptor >= 0) close(*descriptor);
    *descriptor = -1;
  }
}

void LineReader::run() {
  constexpr std::size_t kLongestLine = 32;
  std::string line;
  while (true) {
    std::array<pollfd, 2> waiting{{{wake_, POLLIN, 0}, {device_, POLLIN, 0}}};
    poll(waiting.data(), waiting.size(), -1);
    if (waiting[0].revents != 0) return;
    std::array<char, 64> bytes{};
    const ssize_t count = read(device_, bytes.data(), bytes.size());
    if (count <= 0) {
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      online_ = false;
      return;
    }
    for (ssize_t i = 0; i < count; ++i) {
      const char letter = bytes[static_cast<std::size_t>(i)];
      if (letter == '\n') {
        take(line);
        line.clear();
      } else if (line.size() < kLongestLine) {
        line += letter;
      }
    }
  }
}

void LineReader::take(const std::string& line) {
  float celsius = 0.0F;
  const char* end = line.data() + line.size();
  const auto [stopped, error] = std::from_chars(line.data(), end, celsius);
  if (error != std::errc{} || stopped != end) {
    ++damaged_;
    return;
  }
  latest_.store({celsius, latest_.load(std::memory_order_relaxed).number + 1},
                std::memory_order_release);
}
