// SPDX-License-Identifier: LGPL-3.0-or-later
/// The calls that a job or hook may not make, one for each row of rt/calls/process_wide.def.
#pragma once

#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <locale>
#include <map>
#include <new>
#include <string>

#include <fcntl.h>
#include <grp.h>
#include <malloc.h>
#include <pthread.h>
#include <pty.h>
#include <sched.h>
#include <spawn.h>
#include <sys/fsuid.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>
#include <utmp.h>

// Some of the calls are deprecated, and are called all the same.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace mauve::rt {

using Call = void (*)();

/// Of calls whose results do not matter.
template <typename Result>
void use(Result /*result*/) {}

inline void handle(int /*signal*/) {}
inline sigset_t ends_mauved() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  return set;
}
inline void handle_exit(int /*status*/, void* /*argument*/) {}

/// Each row by its name. The arguments are such that a call which is not refused does little.
inline const std::map<std::string, Call> kCalls{
    {"chdir", [] { use(chdir("/")); }},
    {"fchdir", [] { use(fchdir(open("/", O_PATH | O_CLOEXEC))); }},
    {"chroot", [] { use(chroot("/nowhere")); }},
    {"umask", [] { use(umask(umask(0))); }},
    {"close", [] { use(close(0)); }},
    {"close_range", [] { use(close_range(0, 0, 0)); }},
    {"closefrom", [] { closefrom(0); }},
    {"dup2", [] { use(dup2(1, 0)); }},
    {"dup3", [] { use(dup3(1, 0, 0)); }},
    {"fclose", [] { use(fclose(stdin)); }},
    {"fcloseall", [] { use(fcloseall()); }},
    {"login_tty", [] { use(login_tty(-1)); }},
    {"freopen", [] { use(freopen("/dev/null", "r", stdin)); }},
    {"freopen64", [] { use(freopen64("/dev/null", "r", stdin)); }},
    {"setenv", [] { use(setenv("MAUVE_NEVER_SET", "1", 0)); }},
    {"unsetenv", [] { use(unsetenv("PATH")); }},
    {"putenv", [] { use(putenv(const_cast<char*>("MAUVE_NEVER_SET=1"))); }},
    {"clearenv", [] { use(clearenv()); }},
    {"setlocale", [] { use(setlocale(LC_ALL, "C.UTF-8")); }},
    {"sigaction",
     [] {
       struct sigaction action {};
       action.sa_handler = handle;
       use(sigaction(SIGUSR1, &action, nullptr));
     }},
    {"signal", [] { use(signal(SIGUSR1, handle)); }},
    {"ssignal", [] { use(ssignal(SIGUSR1, handle)); }},
    {"sysv_signal", [] { use(sysv_signal(SIGUSR1, handle)); }},
    {"__sysv_signal", [] { use(__sysv_signal(SIGUSR1, handle)); }},
    {"sigset", [] { use(sigset(SIGUSR1, handle)); }},
    {"sigignore", [] { use(sigignore(SIGUSR1)); }},
    {"siginterrupt", [] { use(siginterrupt(SIGUSR1, 1)); }},
    {"sighold", [] { use(sighold(SIGUSR1)); }},
    {"sigrelse", [] { use(sigrelse(SIGUSR1)); }},
    {"sigblock", [] { use(sigblock(1 << SIGUSR1)); }},
    {"sigsetmask", [] { use(sigsetmask(0)); }},
    {"sigwait",
     [] {
       const sigset_t end = ends_mauved();
       int signal = 0;
       use(sigwait(&end, &signal));
     }},
    {"sigwaitinfo",
     [] {
       const sigset_t end = ends_mauved();
       use(sigwaitinfo(&end, nullptr));
     }},
    {"sigtimedwait",
     [] {
       const sigset_t end = ends_mauved();
       const timespec now{};
       use(sigtimedwait(&end, nullptr, &now));
     }},
    {"signalfd",
     [] {
       const sigset_t end = ends_mauved();
       use(signalfd(-1, &end, SFD_CLOEXEC));
     }},
    {"sigaltstack",
     [] {
       stack_t none{};
       none.ss_flags = SS_DISABLE;
       use(sigaltstack(&none, nullptr));
     }},
    {"alarm", [] { use(alarm(0)); }},
    {"ualarm", [] { use(ualarm(0, 0)); }},
    {"setitimer",
     [] {
       const itimerval never{};
       use(setitimer(ITIMER_REAL, &never, nullptr));
     }},
    {"timer_create",
     [] {
       timer_t timer{};
       use(timer_create(CLOCK_MONOTONIC, nullptr, &timer));
     }},
    {"mlockall", [] { use(mlockall(0)); }},
    {"munlockall", [] { use(munlockall()); }},
    {"mallopt", [] { use(mallopt(-1000, 0)); }},
    {"fork",
     [] {
       if (fork() == 0) _exit(1);
     }},
    {"vfork",
     [] {
       if (vfork() == 0) _exit(1);
     }},
    {"_Fork",
     [] {
       if (_Fork() == 0) _exit(1);
     }},
    {"forkpty",
     [] {
       int end = -1;
       if (forkpty(&end, nullptr, nullptr, nullptr) == 0) _exit(1);
     }},
    {"daemon", [] { use(daemon(1, 1)); }},
    {"system", [] { use(system("true")); }},
    {"execve", [] { use(execve("/nowhere", environ, environ)); }},
    {"execv", [] { use(execv("/nowhere", environ)); }},
    {"execvp", [] { use(execvp("/nowhere", environ)); }},
    {"execvpe", [] { use(execvpe("/nowhere", environ, environ)); }},
    {"fexecve", [] { use(fexecve(-1, environ, environ)); }},
    {"execveat", [] { use(execveat(-1, "nowhere", environ, environ, 0)); }},
    {"execl", [] { use(execl("/nowhere", "a", nullptr)); }},
    {"execlp", [] { use(execlp("/nowhere", "a", nullptr)); }},
    {"execle", [] { use(execle("/nowhere", "a", nullptr, environ)); }},
    {"on_exit", [] { use(on_exit(handle_exit, nullptr)); }},
    {"setuid", [] { use(setuid(getuid())); }},
    {"seteuid", [] { use(seteuid(geteuid())); }},
    {"setreuid", [] { use(setreuid(getuid(), geteuid())); }},
    {"setresuid", [] { use(setresuid(getuid(), geteuid(), geteuid())); }},
    {"setfsuid", [] { use(setfsuid(geteuid())); }},
    {"setgid", [] { use(setgid(getgid())); }},
    {"setegid", [] { use(setegid(getegid())); }},
    {"setregid", [] { use(setregid(getgid(), getegid())); }},
    {"setresgid", [] { use(setresgid(getgid(), getegid(), getegid())); }},
    {"setfsgid", [] { use(setfsgid(getegid())); }},
    {"setgroups", [] { use(setgroups(1000000, nullptr)); }},
    {"initgroups", [] { use(initgroups("nobody of that name", 0)); }},
    {"setrlimit",
     [] {
       rlimit limit{};
       use(getrlimit(RLIMIT_CORE, &limit));
       use(setrlimit(RLIMIT_CORE, &limit));
     }},
    {"setrlimit64",
     [] {
       rlimit64 limit{};
       use(getrlimit64(RLIMIT_CORE, &limit));
       use(setrlimit64(RLIMIT_CORE, &limit));
     }},
    {"prlimit",
     [] {
       rlimit limit{};
       use(getrlimit(RLIMIT_CORE, &limit));
       use(prlimit(0, RLIMIT_CORE, &limit, nullptr));
     }},
    {"prlimit64",
     [] {
       rlimit64 limit{};
       use(getrlimit64(RLIMIT_CORE, &limit));
       use(prlimit64(0, RLIMIT_CORE, &limit, nullptr));
     }},
    {"prctl", [] { use(prctl(PR_SET_DUMPABLE, 1, 0, 0, 0)); }},
    {"unshare", [] { use(unshare(0)); }},
    {"setns", [] { use(setns(-1, 0)); }},
    {"setsid", [] { use(setsid()); }},
    {"setpgrp", [] { use(setpgrp()); }},
    {"setpgid", [] { use(setpgid(0, getpgrp())); }},
    {"nice", [] { use(nice(0)); }},
    {"setpriority", [] { use(setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0))); }},
    {"sched_setscheduler",
     [] {
       const sched_param none{};
       use(sched_setscheduler(0, SCHED_OTHER, &none));
     }},
    {"sched_setparam",
     [] {
       const sched_param none{};
       use(sched_setparam(0, &none));
     }},
    {"sched_setaffinity",
     [] {
       cpu_set_t cpus{};
       use(sched_getaffinity(0, sizeof cpus, &cpus));
       use(sched_setaffinity(0, sizeof cpus, &cpus));
     }},
    {"pthread_setschedparam",
     [] {
       const sched_param none{};
       use(pthread_setschedparam(pthread_self(), SCHED_OTHER, &none));
     }},
    {"pthread_setschedprio", [] { use(pthread_setschedprio(pthread_self(), 0)); }},
    {"pthread_setaffinity_np",
     [] {
       cpu_set_t cpus{};
       use(sched_getaffinity(0, sizeof cpus, &cpus));
       use(pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus));
     }},
    {"pthread_setattr_default_np",
     [] {
       pthread_attr_t attributes;
       use(pthread_getattr_default_np(&attributes));
       use(pthread_setattr_default_np(&attributes));
     }},
    {"pthread_cancel", [] { use(pthread_cancel(pthread_self())); }},
    {"std::set_terminate", [] { use(std::set_terminate(std::get_terminate())); }},
    {"std::set_new_handler", [] { use(std::set_new_handler(std::get_new_handler())); }},
    {"std::locale::global", [] { use(std::locale::global(std::locale::classic())); }},
};

}  // namespace mauve::rt

#pragma GCC diagnostic pop
