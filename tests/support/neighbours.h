// SPDX-License-Identifier: LGPL-3.0-or-later
/// Neighbours: other programs that may run on a robot's computer, all at once. Two compilers, a
/// busy real-time program, and another mauved that starts again and again.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <list>
#include <string>
#include <thread>
#include <vector>

#include "rt/thread/futex.h"
#include "rt/thread/thread.h"
#include "support/process.h"
#include "support/temp_dir.h"

#include <mauve/host/clock.h>

namespace mauve::test {

/// On each CPU a SCHED_FIFO thread that copies values of 1 MB for 2 ms of every 10 ms.
class BusyRealtime {
 public:
  static constexpr int kPriority = 50;
  static constexpr Instant kPeriod = 10'000'000;
  static constexpr Instant kBusy = 2'000'000;

  BusyRealtime() {
    for (const int cpu : rt::usable_cpus()) {
      auto& thread = threads_.emplace_back();
      running_ = thread.start({"busy", kPriority, {cpu}}, [this] { run(); }) && running_;
    }
  }
  ~BusyRealtime() { quit_ = true; }
  [[nodiscard]] bool running() const { return running_; }

 private:
  void run() {
    std::vector<char> from(1'000'000, 'a');
    std::vector<char> to(from.size());
    const std::atomic<std::uint32_t> never{0};
    const MonotonicClock clock;
    for (Instant next = clock.now() + kPeriod; !quit_; next += kPeriod) {
      while (clock.now() < next) rt::futex_wait_until(never, 0, next);
      for (const Instant end = clock.now() + kBusy; clock.now() < end;) {
        std::memcpy(to.data(), from.data(), from.size());
        from[0] = static_cast<char>(to[0] + 1);
      }
    }
  }

  std::atomic<bool> quit_{false};
  bool running_ = true;
  std::list<rt::Thread> threads_;
};

/// All of them, until the end of the object's life. MAUVE_BIN_DIR, MAUVE_PLUGIN_DIR and
/// MAUVE_SOURCE_DIR are defined by the CMakeLists.txt of the test.
class Neighbours {
 public:
  Neighbours() : another_([this] { start_another_mauved_again_and_again(); }) {
    const std::string source = place_.write("busy.cpp", "#include <regex>\n#include <map>\n");
    for (int i = 0; i < 2; ++i) {
      compilers_.emplace_back(std::vector<std::string>{
          "/bin/sh", "-c",
          "until [ -e " + stop_ + " ]; do c++ -std=c++20 -O2 -c -o /dev/null " + source +
              "; done"});
    }
  }
  ~Neighbours() {
    quit_ = true;
    static_cast<void>(place_.write("stop", ""));
    for (Process& compiler : compilers_) static_cast<void>(compiler.wait());
    another_.join();
  }
  /// True when each of them has begun.
  [[nodiscard]] bool running() {
    return realtime_.running() && compilers_.front().running() && compilers_.back().running() &&
           eventually([this] { return starts_.load() > 0; });
  }

 private:
  void start_another_mauved_again_and_again() {
    while (!quit_) {
      Process mauved({MAUVE_BIN_DIR "/mauved", MAUVE_SOURCE_DIR "/etc/rover.json", "--socket",
                      (place_ / "another.sock").string(), "--plugin-dir", MAUVE_PLUGIN_DIR,
                      "--admission", "strict"});
      ++starts_;
      std::this_thread::sleep_for(std::chrono::milliseconds(1500));
      mauved.signal(SIGTERM);
      static_cast<void>(eventually([&] { return !mauved.running(); }));
    }
  }

  TempDir place_;
  const std::string stop_ = (place_ / "stop").string();
  std::atomic<bool> quit_{false};
  std::atomic<int> starts_{0};  // of the other mauved
  BusyRealtime realtime_;
  std::list<Process> compilers_;
  std::thread another_;
};

}  // namespace mauve::test
