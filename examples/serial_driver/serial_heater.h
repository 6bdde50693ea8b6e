// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "serial_heater/driver": a heater on a serial line. It sends a line of text for
/// each measurement, such as "21.50", and takes its power in percent, such as "P35".
#pragma once

#include <mauve/guarded.h>
#include <mauve/plugin.h>
#include <mauve/serial/device_line.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace serial_heater {

using namespace std::chrono_literals;

struct Shell : mauve::Shell {
  /// Percent. The device obeys it, so one port at most may write into its resource.
  mauve::ReadPort<double> power{*this, "power", mauve::Need::required, mauve::Writers::one};
  mauve::WritePort<double> temperature{*this, "temperature"};  // degrees Celsius
};

/// All that the next core needs to continue: described, so that a reload compares its layout.
struct Line {
  mauve::serial::LineBytes bytes;            // received, and not used yet
  mauve::Bounded<std::uint8_t, 32> letters;  // of the line of text that has begun
  double power = 0.0;                        // that was sent last, in percent
  std::int64_t sent = 0;                     // when that was, monotonic in ns

  static constexpr std::string_view type_name = "serial_heater_line/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("bytes", &Line::bytes), mauve::field("letters", &Line::letters),
                      mauve::field("power", &Line::power, "%"),
                      mauve::field("sent", &Line::sent, "ns")};
  }
};

class Driver final : public mauve::Core<Shell> {
 public:
  mauve::State<Line> state{*this};
  mauve::Guarded heater_off{*this, "heater_off"};
  /// The properties `device` and `baud`, and the counters of the line.
  mauve::serial::DeviceLine line{*this, {.device = "/dev/ttyUSB0", .baud = 9600}};
  mauve::Property<double> ramp{*this,
                               "ramp",
                               100.0,
                               "fastest change of the power",
                               {.unit = "%/s", .min = 1.0, .max = 10'000.0}};
  mauve::Observable<bool> online{*this, "online", false, "the device is there"};
  mauve::Observable<int> damaged{*this, "damaged", 0, "lines that were no temperature"};
  mauve::Observable<double> power{*this, "power", 0.0, "that the device was sent last", "%"};

  /// [rt] every period. No call here waits for the device.
  void update() {
    online = !line.lost() || line.reopen();
    if (!online) {
      state->power = 0.0;  // it comes back without power
      return;
    }
    hear();
    command();
  }

 private:
  /// [factory] All that may fail happens here, beside the running system.
  mauve::Status on_configure() override {
    line.guard(heater_off, {.bytes = "P0\n", .times = 3, .apart = 10ms});
    return line.open();
  }
  void on_cleanup() override { line.close(state->bytes); }

  void hear() {
    char letter = 0;
    while (line.take(state->bytes, letter)) {
      if (letter != '\n') {
        state->letters.push_back(static_cast<std::uint8_t>(letter));
        continue;
      }
      use(state->letters);
      state->letters.clear();
    }
  }

  void use(const mauve::Bounded<std::uint8_t, 32>& letters) {
    std::array<char, 32> text{};
    const char* const end = std::copy(letters.begin(), letters.end(), text.begin());
    double celsius = 0.0;
    const auto [stopped, error] = std::from_chars(text.data(), end, celsius);
    if (error != std::errc{} || stopped != end || letters.full()) {
      ++damaged;
    } else {
      shell().temperature.write(celsius);
    }
  }

  /// Sent in each period, so that the device may switch itself off when no command comes.
  void command() {
    const mauve::Instant now = mauve::job_time();
    // The device was made safe while the component was stopped.
    if (now - state->sent > mauve::Duration{500ms}.count()) state->power = 0.0;
    const double step = ramp * mauve::to_seconds(mauve::time_step());
    state->power = std::clamp(wanted(), state->power - step, state->power + step);
    state->sent = now;
    power = state->power;
    std::array<char, 8> text{'P'};
    char* end = text.data() + 1;
    end = std::to_chars(end, text.end() - 1, std::lround(state->power)).ptr;
    *end++ = '\n';
    line.send({text.data(), static_cast<std::size_t>(end - text.data())});
  }

  /// No power without a command that is fresh (`max_age` of the connection) and a number.
  double wanted() {
    const double percent = shell().power.read();
    const mauve::DataStatus status = shell().power.status();
    if (!has_value(status) || status == mauve::DataStatus::stale) return 0.0;
    return std::isfinite(percent) ? std::clamp(percent, 0.0, 100.0) : 0.0;
  }
};

}  // namespace serial_heater
