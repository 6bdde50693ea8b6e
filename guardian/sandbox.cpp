// SPDX-License-Identifier: LGPL-3.0-or-later
#include "sandbox.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "say.h"

namespace mauve::guardian {
namespace {

constexpr int kPriority = 97;  // mauved: components up to 94, the guard 95, the crash handler 96

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

#if defined(__x86_64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr unsigned kArchitecture = 0;
#endif

constexpr std::array kCalls{
    SYS_write,      SYS_pread64,         SYS_recvmsg,         SYS_sendto,
    SYS_futex,      SYS_clock_nanosleep, SYS_clock_gettime,   SYS_ppoll,
    SYS_ioctl,      SYS_fcntl,           SYS_close,           SYS_accept4,
    SYS_getsockopt, SYS_pidfd_open,      SYS_openat,          SYS_mmap,
    SYS_munmap,     SYS_fstat,           SYS_newfstatat,      SYS_geteuid,
    SYS_exit_group, SYS_rt_sigreturn,    SYS_restart_syscall,
#ifdef SYS_poll
    SYS_poll,
#endif
};

}  // namespace

void become_urgent() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    say("its memory cannot be locked (%s): it may be late when memory is short.",
        std::strerror(errno));
  }
  const sched_param urgent{kPriority};
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &urgent) != 0) {
    say("it cannot be real time (%s): beside real-time threads it may be late.",
        std::strerror(errno));
  }
  const int score = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score >= 0) {
    if (write(score, "-1000", 5) < 0 && errno != EACCES)
      say("its place before the OOM killer stays.");
    close(score);
  }
}

void confine_calls() {
  if (kSanitized || kArchitecture == 0) return;
  constexpr auto statement = [](unsigned code, unsigned value) {
    return sock_filter{static_cast<std::uint16_t>(code), 0, 0, value};
  };
  constexpr auto jump = [](unsigned value, unsigned yes, unsigned no) {
    return sock_filter{BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(yes),
                       static_cast<std::uint8_t>(no), value};
  };
  constexpr unsigned kLoad = BPF_LD | BPF_W | BPF_ABS;
  constexpr unsigned kReturn = BPF_RET | BPF_K;
  std::array<sock_filter, kCalls.size() + 6> filter{};
  std::size_t at = 0;
  filter[at++] = statement(kLoad, offsetof(seccomp_data, arch));
  filter[at++] = jump(kArchitecture, 1, 0);
  filter[at++] = statement(kReturn, SECCOMP_RET_KILL_PROCESS);
  filter[at++] = statement(kLoad, offsetof(seccomp_data, nr));
  for (std::size_t i = 0; i < kCalls.size(); ++i) {
    filter[at++] = jump(static_cast<unsigned>(kCalls[i]), static_cast<unsigned>(kCalls.size() - i),
                        0);  // to the last statement
  }
  filter[at++] = statement(kReturn, SECCOMP_RET_ERRNO | EPERM);
  filter[at++] = statement(kReturn, SECCOMP_RET_ALLOW);
  const sock_fprog program{static_cast<unsigned short>(at), filter.data()};
  const bool done = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  if (!done) say("its system calls cannot be confined (%s).", std::strerror(errno));
}

}  // namespace mauve::guardian
