// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/called_thread.h>

#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

namespace mauve::serial {
namespace {

constexpr std::size_t kStack = 256 * 1024;  // memory is locked: the usual 8 MB would be real

/// Signals are for the threads of mauved, except those that this thread causes itself.
void introduce(const char* name) {
  prctl(PR_SET_NAME, name);
  sigset_t all;
  sigfillset(&all);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigdelset(&all, own);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

mauve::Status CalledThread::begin(const char* name, std::function<void()> run) {
  join();
  Descriptor bell(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (!bell.open()) {
    return mauve::refuse(mauve::Errc::system, {}, "cannot create an eventfd for a serial line");
  }
  bell_ = std::move(bell);
  name_ = name;
  run_ = std::move(run);
  const auto enter = [](void* self) -> void* {
    auto& thread = *static_cast<CalledThread*>(self);
    introduce(thread.name_);
    if (thread.hurried_.exchange(false)) thread.raise_priority();
    thread.run_();
    return nullptr;
  };
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStack);
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  const int error = pthread_create(&thread_, &attributes, enter, this);
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    return mauve::refuse(
        mauve::Errc::system, {},
        "cannot start a thread of a serial line: " + std::generic_category().message(error),
        "is RLIMIT_MEMLOCK or the number of tasks too small?");
  }
  runs_ = true;
  return mauve::ok();
}

void CalledThread::join() {
  if (std::exchange(runs_, false)) pthread_join(thread_, nullptr);
  hurried_ = false;
}

/// No write to an eventfd waits for its reader.
void CalledThread::call() const {
  const std::uint64_t one = 1;
  static_cast<void>(::write(bell_.number(), &one, sizeof one));
}

void CalledThread::hurry() {
  hurried_ = true;
  call();
}

bool CalledThread::caller_is_real_time() { return sched_getscheduler(0) == SCHED_FIFO; }

bool CalledThread::wait(int longest, pollfd* other) {
  const pollfd none{-1, 0, 0};
  std::array<pollfd, 2> both{pollfd{bell_.number(), POLLIN, 0}, other != nullptr ? *other : none};
  ::poll(both.data(), both.size(), longest);
  if (other != nullptr) other->revents = both[1].revents;
  const bool called = (both[0].revents & POLLIN) != 0;
  std::uint64_t calls = 0;
  if (called) static_cast<void>(::read(bell_.number(), &calls, sizeof calls));
  if (hurried_.exchange(false)) raise_priority();
  return called;
}

void CalledThread::raise_priority() {
  const sched_param low{sched_get_priority_min(SCHED_FIFO) + 1};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &low));
}

}  // namespace mauve::serial
