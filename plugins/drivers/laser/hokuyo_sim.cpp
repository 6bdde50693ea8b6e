// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/hokuyo_sim": a Hokuyo scanner at the far end of a serial line. It
/// answers SCIP 2.0 (scip.h) on a pseudo-terminal, whose other end is the device named by `line`,
/// so that the real driver runs on it. One turn each period; a step of the scanner is a beam of the
/// world's scan. List it before the driver: the device must be there when the driver opens it.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <mauve/job.h>
#include <mauve/serial/simulated_line.h>

#include "../parts.h"
#include "scip_write.h"

namespace drivers {
namespace {

struct ScannerShell : mauve::Shell {
  mauve::ReadPort<rover::LaserScan> world{*this, "world", mauve::Need::required};
};

class HokuyoSim final : public mauve::Core<ScannerShell> {
 public:
  void update() {
    if (!has_value(shell().world.read(seen_))) return;
    limits_ = scip::limits_of(seen_, turns);
    hear();
    if (measuring_) turn();
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::serial::SimulatedLine line{*this, "line", "pty:laser"};
  mauve::Property<int> turns{*this,
                             "turns",
                             2400,
                             "as it says of itself; what counts is fsm.period",
                             {.unit = "1/min", .min = 1, .max = 60'000}};
  mauve::Property<bool> covered{*this, "covered", false, "measures error codes only"};
  mauve::Observable<std::uint64_t> requests{*this, "requests", 0, "answered"};
  mauve::Observable<std::uint64_t> scans{*this, "scans", 0, "sent"};
  mauve::Observable<std::uint64_t> lost{*this, "lost", 0, "not sent: nobody reads the line"};

  mauve::Status on_configure() override {
    measuring_ = false;
    return line.open();
  }
  void on_cleanup() override { line.close(); }

  void hear() {
    std::array<char, 256> bytes{};
    const std::size_t count = line.receive(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (!heard_.push(bytes[i]) || heard_.too_long() || heard_.line().empty()) continue;
      ++requests;
      line.send(answer(heard_.line()));
    }
  }

  std::string_view answer(std::string_view request) {
    if (request == "QT") {
      measuring_ = false;
      return writer_.reply(request, "00");
    }
    if (request == "BM") return writer_.reply(request, std::exchange(on_, true) ? "02" : "00");
    if (request == "PP") return writer_.limits(request, limits_);
    const auto wanted = scip::Request::parse(request);
    if (!wanted) return writer_.reply(request, "0E");
    if (wanted->first < limits_.amin || wanted->last > limits_.amax) {
      return writer_.reply(request, "04");
    }
    wanted_ = *wanted;
    measuring_ = true;
    return writer_.reply(request, "00");
  }

  void turn() {
    const std::size_t count = scip::measure(seen_, kNothing, steps_);
    if (covered) steps_.fill(0);
    const auto first = static_cast<std::size_t>(wanted_.first - limits_.amin);
    const auto last = static_cast<std::size_t>(wanted_.last - limits_.amin);
    if (last >= count) return;
    const auto stamp = static_cast<std::uint32_t>(mauve::job_time() / 1'000'000);
    const std::span<const std::uint32_t> all(steps_);
    line.send(writer_.scan(wanted_, stamp, all.subspan(first, last - first + 1)), scans, lost);
  }

  static constexpr std::uint32_t kNothing =
      65'533;  // the value of a UTM-30LX when nothing is in sight

  scip::TextReader heard_;
  scip::ReplyWriter writer_;
  scip::Limits limits_;
  scip::Request wanted_;
  rover::LaserScan seen_;
  std::array<std::uint32_t, scip::kMostValues> steps_{};
  bool on_ = false;
  bool measuring_ = false;
};

}  // namespace

void declare_hokuyo_sim(mauve::Plugin& plugin) {
  plugin.component<ScannerShell, HokuyoSim, mauve::PeriodicFsm<HokuyoSim>>("hokuyo_sim");
}

}  // namespace drivers
