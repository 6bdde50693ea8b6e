// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/pi_mutex.h"

#include <time.h>

#include <mauve/host/clock.h>

namespace mauve::rt {

PiMutex::PiMutex() {
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  pthread_mutex_init(&mutex_, &attributes);
  pthread_mutexattr_destroy(&attributes);
}

PiMutex::~PiMutex() { pthread_mutex_destroy(&mutex_); }

bool PiMutex::try_lock() { return pthread_mutex_trylock(&mutex_) == 0; }

bool PiMutex::lock_until(Instant deadline) {
#if defined(__SANITIZE_THREAD__)
  // The sanitizer of gcc 12 does not know pthread_mutex_clocklock().
  timespec real{};
  clock_gettime(CLOCK_REALTIME, &real);
  deadline += Instant{real.tv_sec} * 1'000'000'000 + real.tv_nsec - MonotonicClock().now();
#endif
  timespec until{};
  until.tv_sec = static_cast<time_t>(deadline / 1'000'000'000);
  until.tv_nsec = static_cast<long>(deadline % 1'000'000'000);
#if defined(__SANITIZE_THREAD__)
  return pthread_mutex_timedlock(&mutex_, &until) == 0;
#else
  return pthread_mutex_clocklock(&mutex_, CLOCK_MONOTONIC, &until) == 0;
#endif
}

void PiMutex::lock() { pthread_mutex_lock(&mutex_); }

void PiMutex::unlock() { pthread_mutex_unlock(&mutex_); }

}  // namespace mauve::rt
