// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "ends" of the test of the same name: a component that commands a base to drive, until a
/// file says in which way it shall end.
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <mauve/plugin.h>

#include "../../plugins/types/velocity.h"

namespace ends {
namespace {

[[noreturn]] void loop() {
  for (;;) asm volatile("");
}

/// Beyond what a job may ask for itself.
[[noreturn]] void loop_above_all() {
  const sched_param most{99};
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &most);
  loop();
}

int fill_the_stack(int depth) {
  std::array<char, 4096> much{};
  asm volatile("" : : "r"(much.data()) : "memory");
  return depth < 0 ? 0 : fill_the_stack(depth + 1) + much[0];
}

void write_nowhere() {
  volatile int* volatile nowhere = nullptr;
  *nowhere = 1;
}

void free_twice() {
  void* volatile memory = std::malloc(32);
  std::free(memory);
  std::free(memory);
}

void become_another_program() { execl("/bin/sleep", "sleep", "3", nullptr); }

void close_all() { syscall(SYS_close_range, 0U, ~0U, 0U); }

/// The test has put a limit on it, far below.
void take_all_memory() {
  for (int i = 0; i < 64; ++i) {
    mmap(nullptr, 16 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1,
         0);
  }
}

using Way = void (*)();
constexpr std::array<std::pair<std::string_view, Way>, 17> kWays{{
    {"throw", [] { throw std::runtime_error("enough"); }},
    {"write nowhere", write_nowhere},
    {"full stack", [] { static_cast<void>(fill_the_stack(0)); }},
    {"abort", [] { std::abort(); }},
    {"terminate", [] { std::terminate(); }},
    {"free twice", free_twice},
    {"exit", [] { std::exit(0); }},
    {"quick_exit", [] { std::quick_exit(0); }},
    {"_exit", [] { _exit(0); }},
    {"exit_group", [] { syscall(SYS_exit_group, 0); }},
    {"pthread_exit", [] { pthread_exit(nullptr); }},
    {"exec", become_another_program},
    {"close all", close_all},
    {"out of memory", take_all_memory},
    {"loop", [] { loop(); }},
    {"loop above all", [] { loop_above_all(); }},
    {"sleep",
     [] {
       for (;;) pause();
     }},
}};

struct EnderShell : mauve::Shell {
  mauve::WritePort<rover::Velocity> command{*this, "command", mauve::Safe{rover::Velocity{}}};
};

class Ender final : public mauve::Core<EnderShell> {
 public:
  void update() {
    shell().command.write({0.4, 0.0});
    std::array<char, 64> said{};
    const int open_file = open(file.get().c_str(), O_RDONLY | O_CLOEXEC);
    if (open_file < 0) return;
    const ssize_t length = read(open_file, said.data(), said.size());
    close(open_file);
    const std::string_view wanted(said.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
    for (const auto& [name, way] : kWays) {
      if (name == wanted) way();
    }
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> file{*this, "file", "", "says how to end"};
};

}  // namespace
}  // namespace ends

MAUVE_PLUGIN(plugin) {
  plugin.component<ends::EnderShell, ends::Ender, mauve::PeriodicFsm<ends::Ender>>("ender");
}
