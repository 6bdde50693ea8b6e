// SPDX-License-Identifier: LGPL-3.0-or-later
/// simulated_device LINK: a heater on a pseudo-terminal, to which LINK leads. Each percent of power
/// heats it by 0.1 degree above 21.50. It prints each change of its power.
#include <mauve/serial/serial_port.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

namespace {

using namespace std::chrono_literals;

/// Like the device, it goes on with its last command.
class Heater {
 public:
  void hear(char letter) {
    if (letter != '\n') {
      command_ += letter;
      return;
    }
    const int power = command_[0] == 'P' ? std::atoi(command_.c_str() + 1) : power_;
    command_.clear();
    if (power == power_) return;
    power_ = power;
    std::printf("power %d\n", power_);
    std::fflush(stdout);
  }
  [[nodiscard]] std::string temperature() const {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.2f\n", 21.5 + 0.1 * power_);
    return text.data();
  }

 private:
  std::string command_;
  int power_ = 0;
};

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: simulated_device LINK\n");
    return 2;
  }
  mauve::serial::PseudoTerminal line;
  if (const mauve::Status opened = line.open(words[1]); !opened) {
    std::fprintf(stderr, "%s\n", opened.error().message.c_str());
    return 1;
  }
  Heater heater;
  for (int tick = 0;; ++tick) {
    std::array<char, 256> heard{};
    const std::size_t size = line.receive(heard);
    for (std::size_t i = 0; i < size; ++i) heater.hear(heard[i]);
    if (tick % 10 == 0) line.send(heater.temperature());
    std::this_thread::sleep_for(10ms);
  }
}
