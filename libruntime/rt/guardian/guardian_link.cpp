// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/guardian_link.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include <mauve/host/clock.h>

#include "base/mutex.h"
#include "rt/process/spawn.h"

namespace mauve::rt {
namespace {

using How = GuardianState::How;
using What = GuardianNews::What;

constexpr int kToGreetMs = 1'000;
constexpr int kBetweenAttemptsMs = 1'000;
constexpr int kToEndMs = 500;  // of one that was started here
/// A thread that waits for a descriptor keeps it open after it was closed.
constexpr int kBetweenLooksMs = 50;

Error system_error(const std::string& doing) {
  return refuse({Errc::system, "guardian_failed"}, "guardian",
                doing + ": " + std::generic_category().message(errno));
}

/// Something to read, or the other end is gone.
bool readable_within(int descriptor, int milliseconds) {
  pollfd one{descriptor, POLLIN, 0};
  return poll(&one, 1, milliseconds) > 0;
}

/// Code in this process closed descriptors that it had not opened: no client is heard any more, and
/// a descriptor may belong to another device. The crash handler runs, and the process ends.
[[noreturn]] void lose_all_descriptors() { std::abort(); }

int process_behind(int socket) {
  ucred who{};
  socklen_t size = sizeof who;
  return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 ? who.pid : 0;
}

}  // namespace

namespace guardian {

bool send(int socket, const Request& request, int descriptor) {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> room{};
  iovec part{const_cast<Request*>(&request), sizeof request};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (descriptor >= 0) {
    message.msg_control = room.data();
    message.msg_controllen = room.size();
    cmsghdr* const with = CMSG_FIRSTHDR(&message);
    with->cmsg_level = SOL_SOCKET;
    with->cmsg_type = SCM_RIGHTS;
    with->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(with), &descriptor, sizeof descriptor);
  }
  return sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL) == sizeof request;
}

}  // namespace guardian

Status GuardianLink::start(GuardianPlan plan, Report report) {
  plan_ = std::move(plan);
  report_ = std::move(report);
  if (plan_.use == GuardianUse::off) return ok();
  bell_ = Descriptor(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!bell_) return system_error("cannot wait for outputs");
  GuardedOutputs::of_process().expect(plan_.use, [this] { ring(); });
  return thread_.start({"mauve-link", 0, {}, 64 * 1024}, [this] { run(); });
}

void GuardianLink::stop(bool in_order) {
  leaves_.store(true);
  if (in_order && thread_.running()) GuardedOutputs::of_process().say_goodbye();
  quits_.store(true);
  ring();
  thread_.join();
  if (plan_.use != GuardianUse::off) {
    GuardedOutputs::of_process().expect(GuardianUse::off, nullptr);
  }
}

GuardianState GuardianLink::state() const {
  const MutexLock lock(mutex_);
  return state_;
}

void GuardianLink::run() {
  if (Status opened = page_.open(); !opened) {
    absent(What::absent, to_string(opened.error()));
    GuardedOutputs::of_process().attach(-1);
    return;
  }
  while (!quits_.load()) {
    if (GuardedOutputs::of_process().names().empty()) {
      static_cast<void>(ring_within(-1));
    } else if (!ask_for_one()) {
      static_cast<void>(ring_within(kBetweenAttemptsMs));
    }
  }
  page_.let_go();
  reap();
}

/// False: there is none, or it was lost.
bool GuardianLink::ask_for_one() {
  reap();
  auto socket = connected();
  How how = How::service;
  Status greeted = socket ? greet(socket->get()) : Status(socket.error());
  if (!greeted && !plan_.command.empty()) {  // also when the service is deaf, or has another one
    socket = started();
    how = How::started;
    greeted = socket ? greet(socket->get()) : Status(socket.error());
  }
  if (!greeted) {
    absent(What::absent, greeted.error().message);
    GuardedOutputs::of_process().attach(-1);
    return false;
  }
  found(how, socket->get());
  GuardedOutputs::of_process().attach(socket->get());
  serve(socket->get());
  GuardedOutputs::of_process().detach();
  if (!leaves_.load()) absent(What::lost, "it ended, or closed the connection");
  return false;
}

Result<Descriptor> GuardianLink::connected() const {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (plan_.socket.empty() || plan_.socket.size() >= sizeof address.sun_path) {
    return refuse({Errc::wrong_state, "guardian_has_no_socket"}, "guardian",
                  "there is no socket of a guardian");
  }
  plan_.socket.copy(address.sun_path, sizeof address.sun_path - 1);
  Descriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const auto* const place = reinterpret_cast<const sockaddr*>(&address);
  if (!socket || connect(socket.get(), place, sizeof address) != 0) {
    return system_error("no guardian serves " + plan_.socket);
  }
  return socket;
}

Result<Descriptor> GuardianLink::started() {
  constexpr int kItsSocket = 3;
  std::array<int, 2> pair{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0) {
    return system_error("cannot make a connection");
  }
  Descriptor ours(pair[0]);
  const Descriptor its(pair[1]);
  auto command = plan_.command;
  command.push_back(std::to_string(kItsSocket));
  const auto child = spawn(command, {STDERR_FILENO, STDERR_FILENO, STDERR_FILENO, its.get()});
  if (!child) return child.error();
  child_ = *child;
  return ours;
}

Status GuardianLink::greet(int socket) const {
  guardian::Request hello;
  hello.thread = page_.owner();
  hello.silence_ms = static_cast<std::uint32_t>(plan_.silence / Duration{1ms});
  if (!guardian::send(socket, hello, page_.file())) return system_error("it takes no message");
  guardian::Answer answer;
  if (!readable_within(socket, kToGreetMs)) {
    return refuse({Errc::timed_out, "guardian_silent"}, "guardian",
                  "it does not answer: it may serve another mauved at this moment");
  }
  if (recv(socket, &answer, sizeof answer, MSG_DONTWAIT) != sizeof answer) {
    return refuse({Errc::system, "guardian_failed"}, "guardian", "it closed the connection");
  }
  answer.text.back() = '\0';
  if (answer.done == 0)
    return refuse({Errc::system, "guardian_failed"}, "guardian", answer.text.data());
  return ok();
}

/// Until the connection ends, or stop().
void GuardianLink::serve(int socket) {
  struct stat before {};
  struct stat now {};
  fstat(socket, &before);
  for (;;) {
    std::array<pollfd, 2> both{{{socket, POLLIN, 0}, {bell_.get(), POLLIN, 0}}};
    poll(both.data(), both.size(), kBetweenLooksMs);
    if (fstat(socket, &now) != 0 || now.st_ino != before.st_ino) lose_all_descriptors();
    if (both[0].revents != 0 && !read_all(socket)) return;
    static_cast<void>(ring_within(0));
    if (quits_.load()) return;
  }
}

/// False: the connection has ended.
bool GuardianLink::read_all(int socket) {
  for (;;) {
    guardian::Answer answer;
    const ssize_t got = recv(socket, &answer, sizeof answer, MSG_DONTWAIT);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return true;
    if (got != sizeof answer) return false;
    answer.text.back() = '\0';
    if (answer.kind == guardian::Kind::silence) {
      report_({What::silence, std::chrono::milliseconds(answer.lasted_ms), answer.done,
               answer.total, state()});
    } else {
      GuardedOutputs::of_process().take(answer);
    }
  }
}

void GuardianLink::found(How how, int socket) {
  GuardianNews news;
  {
    const MutexLock lock(mutex_);
    if (state_.how == How::none) news.lasted = Duration{MonotonicClock().now() - state_.since};
    state_ = {how, {}, 0, how == How::started ? child_ : process_behind(socket)};
    news.state = state_;
  }
  report_(news);
}

void GuardianLink::absent(What what, const std::string& why) {
  GuardianNews news;
  news.what = what;
  {
    const MutexLock lock(mutex_);
    const bool known = state_.how == How::none;
    if (!known) state_.since = MonotonicClock().now();
    state_.how = How::none;
    state_.why = why;
    state_.process = 0;
    if (known) return;
    news.state = state_;
  }
  report_(news);
}

/// One that was started here ends when its connection does.
void GuardianLink::reap() {
  for (int waited = 0; child_ != 0; ++waited) {
    const pid_t ended = waitpid(child_, nullptr, WNOHANG);
    if (ended != 0) child_ = 0;
    if (waited == kToEndMs) return;
    if (child_ != 0) poll(nullptr, 0, 1);
  }
}

bool GuardianLink::ring_within(int milliseconds) const {
  if (!readable_within(bell_.get(), milliseconds)) return false;
  std::uint64_t times = 0;
  return read(bell_.get(), &times, sizeof times) == sizeof times;
}

void GuardianLink::ring() const {
  constexpr std::uint64_t kOnce = 1;
  if (write(bell_.get(), &kOnce, sizeof kOnce) < 0) return;
}

}  // namespace mauve::rt
