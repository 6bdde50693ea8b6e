// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/child.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/mutex.h"
#include "rt/process/spawn.h"

namespace mauve::rt {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

constexpr int kCrashHandlerMs = 200;
constexpr int kLessUrgent = 5;

Error failed(const char* doing, int number) {
  return refuse({Errc::system, "process_not_started"}, {},
                std::string("cannot ") + doing + ": " + std::strerror(number));
}

void limit(__rlimit_resource resource, std::uint64_t most) {
  rlimit present{};
  if (getrlimit(resource, &present) != 0) return;
  const auto wanted = static_cast<rlim_t>(most);
  const rlimit next{std::min(wanted, present.rlim_cur), std::min(wanted, present.rlim_max)};
  static_cast<void>(setrlimit(resource, &next));
}

void drop_capabilities() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> none{};
  static_cast<void>(syscall(SYS_capset, &header, none.data()));
}

/// A file in memory that holds the text, read from its beginning.
Result<Descriptor> file_with(const std::string& text, const char* name) {
  Descriptor file(memfd_create(name, MFD_CLOEXEC));
  if (!file) return failed("make a file in memory", errno);
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t part = write(file.get(), text.data() + written, text.size() - written);
    if (part < 0 && errno == EINTR) continue;
    if (part <= 0) return failed("write a file in memory", errno);
    written += static_cast<std::size_t>(part);
  }
  if (lseek(file.get(), 0, SEEK_SET) != 0) return failed("read a file in memory", errno);
  return file;
}

std::string text_of(const Descriptor& file) {
  std::string text;
  std::array<char, 65536> part{};
  off_t from = 0;
  for (;;) {
    const ssize_t got = pread(file.get(), part.data(), part.size(), from);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
    from += got;
  }
}

/// Whether the child ended within the time; it is not reaped.
bool ended_within(const Descriptor& child, int milliseconds) {
  pollfd one{child.get(), POLLIN, 0};
  int ready = 0;
  do {
    ready = poll(&one, 1, milliseconds);
  } while (ready < 0 && errno == EINTR);
  return ready > 0;
}

}  // namespace

void confine(const ChildLimits& limits) {
  static_cast<void>(prctl(PR_SET_PDEATHSIG, SIGKILL));
  static_cast<void>(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0));
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kLessUrgent));
  std::ofstream("/proc/self/oom_score_adj") << "1000";
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_RTPRIO, 0);
  limit(RLIMIT_FSIZE, limits.file);
  limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.processor / Duration{1s}) + 1);
  if (!kSanitized) limit(RLIMIT_DATA, limits.memory);
  drop_capabilities();
}

std::uint64_t quarter_of_memory() {
  const auto pages = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES));
  const auto size = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return pages * size / 4;
}

Result<ChildEnd> ChildRunner::run(const std::vector<std::string>& command, const std::string& input,
                                  Duration within) {
  auto in = file_with(input, "mauve:input");
  auto out = file_with("", "mauve:output");
  auto err = file_with("", "mauve:errors");
  for (const auto* file : {&in, &out, &err}) {
    if (!*file) return file->error();
  }
  auto child = spawn(command, in->get(), out->get(), err->get());
  if (!child) return child.error();
  ChildEnd end = wait(*child, within);
  end.output = text_of(*out);
  end.errors = text_of(*err);
  return end;
}

Result<pid_t> ChildRunner::spawn(const std::vector<std::string>& command, int input, int output,
                                 int errors) {
  const MutexLock lock(mutex_);
  if (cancelled_) return refuse({Errc::wrong_state, "mauved_ends"}, {}, "mauved is about to end");
  auto child = rt::spawn(command, {input, output, errors});
  if (child) child_ = *child;
  return child;
}

ChildEnd ChildRunner::wait(pid_t child, Duration within) {
  ChildEnd end;
  // Code in it may have left the group: the process itself gets each signal too.
  const auto send = [child](int signal) {
    kill(-child, signal);
    kill(child, signal);
  };
  const Descriptor handle(static_cast<int>(syscall(SYS_pidfd_open, child, 0)));
  const auto most = std::chrono::ceil<std::chrono::milliseconds>(within).count();
  if (!handle || !ended_within(handle, static_cast<int>(most))) {
    end.how = ChildEnd::How::late;
    send(SIGTERM);
    if (handle) ended_within(handle, kCrashHandlerMs);
  }
  send(SIGKILL);  // also those that it started; its number is not free yet
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  const MutexLock lock(mutex_);
  child_ = 0;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (cancelled_) {
    end.how = ChildEnd::How::cancelled;
  } else if (end.how != ChildEnd::How::late && WIFSIGNALED(status)) {
    end.how = ChildEnd::How::signalled;
    end.code = WTERMSIG(status);
  } else if (WIFEXITED(status)) {
    end.code = WEXITSTATUS(status);
  }
  return end;
}

void ChildRunner::cancel() {
  const MutexLock lock(mutex_);
  cancelled_ = true;
  if (child_ == 0) return;
  kill(-child_, SIGKILL);
  kill(child_, SIGKILL);
}

}  // namespace mauve::rt
