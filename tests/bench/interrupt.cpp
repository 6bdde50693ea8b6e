// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which jobs that do not return the guard's signal ends, with its ten attempts. The guard abandons
/// the thread of every other one (decision 43).
#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/support/report.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"

#include <mauve/time.h>

namespace bench {
namespace {

using namespace mauve;

constexpr int kAttempts = 10;  // as those of the guard
constexpr Duration kBetween{100us};
constexpr Instant kBegan = 1;  // of the only body

volatile bool forever = true;
volatile long seen = 0;
std::array<int, 2> device{};  // a pipe into which nobody writes
std::mutex held;
std::array<char, 1'000'000> from;
std::array<char, 1'000'000> into;

struct Hang {
  const char* name;
  void (*body)(void*);
};

void own_code(void* /*unused*/) {
  while (forever) seen = seen + 1;
}
void allocation(void* /*unused*/) {
  while (forever) {
    const auto memory = std::make_unique<char[]>(100);
    asm volatile("" : : "r"(memory.get()) : "memory");  // it is not left out
  }
}
void copying(void* /*unused*/) {
  while (forever) {
    std::memcpy(into.data(), from.data(), from.size());
    seen = into[1];
  }
}
void searching(void* /*unused*/) {
  std::map<int, int> all;
  for (int i = 0; i < 1000; ++i) all[i] = i;
  while (forever) {
    for (const auto& [key, value] : all) seen = value;
  }
}
void reading(void* /*unused*/) {
  char byte = 0;
  while (read(device[0], &byte, 1) < 0) seen = seen + 1;
}
void polling(void* /*unused*/) {
  pollfd line{device[0], POLLIN, 0};
  while (poll(&line, 1, -1) <= 0) seen = seen + 1;
}
void sleeping(void* /*unused*/) { std::this_thread::sleep_for(1h); }
void locking(void* /*unused*/) { held.lock(); }

constexpr std::array<Hang, 8> kHangs{{{"a loop in its own code", own_code},
                                      {"a loop that allocates", allocation},
                                      {"a loop that copies 1 MB", copying},
                                      {"a loop over a std::map", searching},
                                      {"a read of a device", reading},
                                      {"a poll without a limit", polling},
                                      {"a sleep", sleeping},
                                      {"a lock that another thread holds", locking}}};

/// In a process of its own, because a thread that does not end would disturb the next one.
[[noreturn]] void hang(const Hang& one) {
  held.lock();
  const rt::FaultHandlers handlers;
  rt::Watched watched;
  watched.busy_since = kBegan;
  std::atomic<bool> ended{false};
  const rt::Boost above(rt::may_use_fifo(21) ? 21 : 0);
  rt::Thread thread;
  const auto run = [&] {
    const rt::FaultStack stack;
    static_cast<void>(rt::run_guarded(one.body, nullptr, watched));
    ended = true;
  };
  rt::ThreadAttributes attributes{"hangs", rt::may_use_fifo(20) ? 20 : 0, {}};
  if (!thread.start(attributes, run)) std::_Exit(0);
  std::this_thread::sleep_for(5ms);
  watched.interrupt = kBegan;
  for (int i = 0; i < kAttempts && !ended; ++i) {
    thread.interrupt();
    std::this_thread::sleep_for(kBetween);
  }
  std::_Exit(ended ? 1 : 0);
}

bool ends(const Hang& one) {
  const pid_t child = fork();
  if (child == 0) hang(one);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 1;
}

void run(const Options& options) {
  Report report("interrupt",
                "Of a hundred jobs that hang in this way, how many the guard's signal ends.",
                options);
  if (pipe(device.data()) != 0) return;
  for (const Hang& one : kHangs) {
    Figure& figure = report.figure(one.name, "%");
    const int times = options.choose(50, 2);
    for (int round = 0; round < options.rounds; ++round) {
      int ended = 0;
      for (int i = 0; i < times; ++i) ended += ends(one) ? 1 : 0;
      figure.add(100.0 * ended / times);
    }
  }
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
