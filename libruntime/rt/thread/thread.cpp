// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/thread.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <optional>
#include <string_view>

#include <alloca.h>
#include <fcntl.h>
#include <limits.h>
#include <sched.h>
#include <unistd.h>

#include "rt/process/fifo.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/stack.h"

namespace mauve::rt {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t kStackFactor = 16;  // instrumented frames are larger
#else
constexpr std::size_t kStackFactor = 1;
#endif
constexpr std::size_t kStackReserve = 16 * 1024;  // not touched: frames below the thread's entry

/// Every page is mapped before the first release.
__attribute__((noinline)) void touch_stack(std::size_t bytes) {
  auto* memory = static_cast<volatile char*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += 4096) memory[i] = 0;
}

/// The first throw of a thread costs 50 to 180 us (unwinder tables); have it now.
void warm_exceptions() {
  try {
    throw 0;
  } catch (int) {
  }
}

cpu_set_t to_set(const std::vector<int>& cpus) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int cpu : cpus) CPU_SET(static_cast<std::size_t>(cpu), &set);
  return set;
}

int caller_policy() {
  sched_param parameter{};
  int policy = SCHED_OTHER;
  pthread_getschedparam(pthread_self(), &policy, &parameter);
  return policy;
}

bool is_realtime(int policy) { return policy == SCHED_FIFO || policy == SCHED_RR; }

Error no_fifo(int priority, int error) {
  if (priority <= 0) {
    return refuse({Errc::system, "thread_not_made"}, "realtime",
                  std::string("cannot create an ordinary thread: ") + std::strerror(error));
  }
  if (error == EPERM) return fifo_refusal(fifo_facts(priority));
  return refuse({Errc::system, "thread_not_made"}, "realtime",
                std::string("cannot create a SCHED_FIFO thread: ") + std::strerror(error));
}

}  // namespace

Thread::~Thread() { join(); }

void* Thread::enter(void* self) {
  auto& thread = *static_cast<Thread*>(self);
  thread.id_.store(gettid());
  std::optional<LockedAsUsed> as_used;
  if (thread.as_used_) {
    as_used.emplace();
  } else {
    touch_stack(thread.stack_ > 2 * kStackReserve ? thread.stack_ - kStackReserve : 4096);
  }
  warm_exceptions();
  thread.body_();
  thread.finished_.store(true);
  return nullptr;
}

Status Thread::start(const ThreadAttributes& attributes, std::function<void()> body) {
  body_ = std::move(body);
  stack_ = attributes.stack;
  as_used_ = attributes.as_used;
  const auto smallest = static_cast<std::size_t>(sysconf(_SC_THREAD_STACK_MIN));
  pthread_attr_t attr;
  pthread_attr_init(&attr);
  pthread_attr_setstacksize(&attr, std::max(attributes.stack * kStackFactor, smallest + 4096));
  // An ordinary thread asks for its policy only where it would inherit that of a real-time thread.
  // A sandbox may refuse every call for a policy, and the kernel refuses one that ends SCHED_IDLE.
  if (attributes.priority > 0 || is_realtime(caller_policy())) {
    sched_param parameter{};
    parameter.sched_priority = attributes.priority;
    pthread_attr_setinheritsched(&attr, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attr, attributes.priority > 0 ? SCHED_FIFO : SCHED_OTHER);
    pthread_attr_setschedparam(&attr, &parameter);
  }
  if (!attributes.cpus.empty()) {
    const cpu_set_t set = to_set(attributes.cpus);
    pthread_attr_setaffinity_np(&attr, sizeof set, &set);
  }
  const int error = pthread_create(&handle_, &attr, &Thread::enter, this);
  pthread_attr_destroy(&attr);
  if (error == EAGAIN) {
    return refuse({Errc::system, "thread_not_made"}, attributes.name,
                  "no memory or no room for one more thread (is RLIMIT_MEMLOCK too small for its "
                  "locked stack?)",
                  "raise RLIMIT_MEMLOCK (LimitMEMLOCK=infinity in a unit), or lower task.stack");
  }
  if (error != 0) return no_fifo(attributes.priority, error);
  running_ = true;
  pthread_setname_np(handle_, attributes.name.substr(0, 15).c_str());
  return ok();
}

void Thread::join() {
  if (!running_) return;
  pthread_join(handle_, nullptr);
  running_ = false;
}

bool Thread::join_if_ended() {
  if (running_) running_ = pthread_tryjoin_np(handle_, nullptr) == EBUSY;
  return !running_;
}

void Thread::abandon() {
  if (running_) pthread_detach(handle_);
  running_ = false;
}

Duration Thread::used() const {
  clockid_t clock{};
  timespec now{};
  if (!running_ || pthread_getcpuclockid(handle_, &clock) != 0) return Duration{0};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

bool Thread::asleep() const {
  std::array<char, 64> path{};
  std::array<char, 256> stat{};
  std::snprintf(path.data(), path.size(), "/proc/self/task/%d/stat", id_.load());
  const int file = open(path.data(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return true;  // not known: a job that never returns has to end all the same
  const ssize_t length = read(file, stat.data(), stat.size() - 1);
  close(file);
  // "12 (its name) R ...": the name may hold anything.
  const std::string_view text(stat.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
  const auto end = text.rfind(") ");
  return end == std::string_view::npos || text.substr(end + 2, 1) != "R";
}

bool Thread::is_fifo(int priority) const {
  int policy = 0;
  sched_param parameter{};
  return running_ && pthread_getschedparam(handle_, &policy, &parameter) == 0 &&
         policy == SCHED_FIFO && parameter.sched_priority == priority;
}

bool Thread::keeps(int priority, const std::vector<int>& cpus) const {
  const int id = id_.load();
  if (!running() || id == 0) return true;
  sched_param parameter{};
  const int policy = sched_getscheduler(id);
  if (policy < 0 || sched_getparam(id, &parameter) != 0) return true;  // it has just ended
  if ((policy & ~SCHED_RESET_ON_FORK) != SCHED_FIFO || parameter.sched_priority != priority) {
    return false;
  }
  cpu_set_t now{};
  const cpu_set_t wanted = to_set(cpus);
  return cpus.empty() || sched_getaffinity(id, sizeof now, &now) != 0 ||
         CPU_EQUAL(&now, &wanted) != 0;
}

Status Thread::set_priority(int priority) {
  const int error = give_priority(handle_, priority);
  if (error != 0) return no_fifo(priority, error);
  return ok();
}

void Thread::interrupt() {
  if (running_) pthread_kill(handle_, kInterrupt);
}

Status Thread::set_cpus(const std::vector<int>& cpus) {
  const cpu_set_t set = to_set(cpus);
  const int error = pthread_setaffinity_np(handle_, sizeof set, &set);
  if (error != 0) {
    return refuse({Errc::system, "cpus_not_possible"}, "cpus",
                  std::string("not possible: ") + std::strerror(error));
  }
  return ok();
}

Status may_use_fifo(int priority) {
  Thread probe;
  return probe.start({"mauve-probe", priority, {}, 64 * 1024}, [] {});
}

std::vector<int> usable_cpus() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &set)) cpus.push_back(cpu);
  }
  return cpus;
}

Status check_cpu(int cpu, const std::string& at) {
  const std::vector<int> usable = usable_cpus();
  if (std::find(usable.begin(), usable.end(), cpu) != usable.end()) return ok();
  return refuse({Errc::invalid_value, "cpu_not_usable"}, at,
                "CPU " + std::to_string(cpu) + " is not one that this process may use",
                "there are " + std::to_string(usable.size()) + " usable CPUs, from " +
                    std::to_string(usable.front()) + " to " + std::to_string(usable.back()));
}

int give_priority(pthread_t thread, int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return pthread_setschedparam(thread, priority > 0 ? SCHED_FIFO : SCHED_OTHER, &parameter);
}

void raise_this_thread(int priority) {
  if (priority > 0) static_cast<void>(give_priority(pthread_self(), priority));
}

Boost::Boost(int priority) {
  sched_param before{};
  int policy = SCHED_OTHER;
  pthread_getschedparam(pthread_self(), &policy, &before);
  if (policy != SCHED_OTHER) return;  // a real-time caller keeps its priority
  raised_ = give_priority(pthread_self(), priority) == 0;
}

Boost::~Boost() {
  if (raised_) give_priority(pthread_self(), 0);
}

}  // namespace mauve::rt
