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
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include <mauve/host/clock.h>

#include "base/duration.h"
#include "base/mutex.h"
#include "rt/process/spawn.h"

namespace mauve::rt {
namespace {

using How = GuardianState::How;
using What = GuardianNews::What;

constexpr int kToGreetMs = 1'000;
constexpr Duration kToServe{10s};  // at a start: a service that is silent, and one of its own
constexpr int kBetweenAttemptsMs = 1'000;
constexpr Duration kBetweenServices = 1s;
constexpr int kToGreetMeanwhileMs = 50;  // while another one serves
constexpr int kToEndMs = 500;            // of one that was started here
/// After two in a row that served for a shorter time the next one may end as soon: it comes later.
constexpr Duration kDiesAgain = 1s;
constexpr int kYoungDeaths = 2;

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

Error deaf() {
  return refuse(
      {Errc::timed_out, "guardian_silent"}, "guardian",
      "it stands still: it did not answer for " + format_duration(GuardianPulse::kPatience));
}

/// The answer has the number 0, and needs no treatment.
void ask(int socket) {
  guardian::Request request;
  request.kind = guardian::Kind::ask;
  static_cast<void>(guardian::send(socket, request, -1));
}

/// Of the process that listened there, or made the socket.
ucred credentials_of(int socket) {
  ucred who{};
  socklen_t size = sizeof who;
  constexpr auto kNobody = static_cast<uid_t>(-1);
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) return {0, kNobody, 0};
  return who;
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
  if (plan_.use == GuardianUse::off) {
    return GuardedOutputs::of_process().expect(GuardianUse::off, nullptr, plan_.priority);
  }
  bell_ = Descriptor(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!bell_) return system_error("cannot wait for outputs");
  Status expected = GuardedOutputs::of_process().expect(
      plan_.use, [this] { ring(); }, plan_.priority);
  if (!expected) return expected;
  return thread_.start({"mauve-link", 0, {}, 64 * 1024}, [this] {
    raise_this_thread(plan_.priority);
    run();
  });
}

void GuardianLink::stop(bool in_order) {
  leaves_.store(true);
  if (in_order) GuardedOutputs::of_process().say_goodbye();
  quits_.store(true);
  ring();
  thread_.join();
  GuardedOutputs::of_process().leave();
}

Status GuardianLink::found_at_start() const {
  MutexLock lock(mutex_);
  const auto settled = [this]() MAUVE_REQUIRES(mutex_) { return state_.how != How::unused; };
  const bool answered = changed_.wait_for(lock, kToServe, settled);
  if (answered && state_.how != How::none) return ok();
  return refuse({Errc::system, "guardian_required"}, "guardian",
                "no guardian serves, and --guardian require asks for one: " +
                    (answered ? state_.why : "none was found in time"),
                "install mauve-guardian beside mauved, or start its service");
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
  const bool at_once = plan_.use == GuardianUse::require;
  while (!quits_.load()) {
    const bool wanted = at_once || !GuardedOutputs::of_process().names().empty();
    if (!wanted || leaves_.load()) {  // after an orderly end no other one is started
      static_cast<void>(ring_within(-1));
    } else if (!ask_for_one()) {
      static_cast<void>(ring_within(kBetweenAttemptsMs));
    }
  }
  page_.let_go();
  let_go_of_former();
  reap();
}

/// False: there is none, or too many were lost so soon that the next one may be too.
bool GuardianLink::ask_for_one() {
  reap();
  How how = How::service;
  auto socket = greeted(how);
  if (!socket) {
    absent(What::absent, socket.error().message);
    let_go_of_former();
    GuardedOutputs::of_process().attach(-1);
    return false;
  }
  found(how, socket->get());
  GuardedOutputs::of_process().attach(socket->get());
  let_go_of_former();
  const Instant since = MonotonicClock().now();
  const End end = serve(how, socket->get());
  GuardedOutputs::of_process().detach();
  lose(end, how, *std::move(socket));
  const bool young = Duration{MonotonicClock().now() - since} < kDiesAgain;
  young_deaths_ = young ? young_deaths_ + 1 : 0;
  return young_deaths_ < kYoungDeaths;
}

/// The service, unless it just proved deaf. Else one that is started here, also when the service
/// does not answer, or has another mauved.
Result<Descriptor> GuardianLink::greeted(How& how) {
  how = How::service;
  if (next_) return std::exchange(next_, Descriptor());
  auto socket = std::exchange(deaf_service_, false) ? Result<Descriptor>(deaf()) : connected();
  Status greeted = socket ? greet(socket->get(), kToGreetMs) : Status(socket.error());
  const bool impostor = !greeted && greeted.error().code == Errc::not_permitted;
  passed_over_ = impostor ? greeted.error().message : "";
  if (!greeted && !plan_.command.empty()) {
    how = How::started;
    socket = started();
    greeted = socket ? greet(socket->get(), kToGreetMs) : Status(socket.error());
  }
  if (!greeted) return greeted.error();
  return socket;
}

/// One that is deaf keeps the outputs until another one has them.
void GuardianLink::lose(End end, How how, Descriptor socket) {
  if (end == End::deaf || end == End::replaced) {
    former_ = {std::move(socket), std::exchange(child_, 0)};
    deaf_service_ = end == End::deaf && how == How::service;
  }
  if (leaves_.load() || end == End::replaced) return;
  absent(What::lost, end == End::deaf ? deaf().message : "it ended, or closed the connection");
}

/// It sends nothing any more, should it ever go on.
void GuardianLink::let_go_of_former() {
  if (former_.socket) {
    guardian::Request request;
    request.kind = guardian::Kind::bye;
    static_cast<void>(guardian::send(former_.socket.get(), request, -1));
  }
  if (former_.child != 0 && kill(former_.child, SIGKILL) == 0) dying_.push_back(former_.child);
  former_ = {};
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
  // It gets the devices, so it is asked before the first message.
  const uid_t its = credentials_of(socket.get()).uid;
  if (its != geteuid() && its != 0) {
    return refuse({Errc::not_permitted, "guardian_not_trusted"}, "guardian",
                  "a process of user " + std::to_string(its) + " listens at " + plan_.socket +
                      ", who is neither root nor the user of mauved: it gets no output");
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

Status GuardianLink::greet(int socket, int milliseconds) const {
  guardian::Request hello;
  hello.thread = page_.owner();
  hello.silence_ms = static_cast<std::uint32_t>(plan_.silence / Duration{1ms});
  if (!guardian::send(socket, hello, page_.file())) return system_error("it takes no message");
  guardian::Answer answer;
  if (!readable_within(socket, milliseconds)) {
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

/// Until the connection ends, nobody answers there any more, or stop().
GuardianLink::End GuardianLink::serve(How how, int socket) {
  struct stat before {};
  struct stat now {};
  fstat(socket, &before);
  const MonotonicClock clock;
  sought_ = clock.now();
  pulse_ = GuardianPulse(clock.now());
  for (;;) {
    std::array<pollfd, 2> both{{{socket, POLLIN, 0}, {bell_.get(), POLLIN, 0}}};
    poll(both.data(), both.size(),
         static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(pulse_.pause()).count()));
    if (fstat(socket, &now) != 0 || now.st_ino != before.st_ino) lose_all_descriptors();
    if (both[0].revents != 0 && !read_all(socket)) return End::closed;
    static_cast<void>(ring_within(0));
    if (quits_.load()) return End::quit;
    const auto sign = pulse_.look(clock.now());
    if (sign == GuardianPulse::Sign::deaf) return End::deaf;
    if (sign == GuardianPulse::Sign::ask) ask(socket);
    if (how == How::started && finds_service(clock.now())) return End::replaced;
  }
}

/// One that was started here ends with the control group of this process; a service that comes
/// later, or comes back, does not.
bool GuardianLink::finds_service(Instant now) {
  if (Duration{now - sought_} < kBetweenServices) return false;
  sought_ = now;
  auto socket = connected();
  if (!socket || !greet(socket->get(), kToGreetMeanwhileMs)) return false;
  next_ = *std::move(socket);
  passed_over_.clear();
  return true;
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
    pulse_.heard();
    if (answer.kind == guardian::Kind::silence) {
      report_({What::silence, std::chrono::milliseconds(answer.lasted_ms), answer.done,
               answer.total, state()});
    } else if (answer.number != 0) {
      GuardedOutputs::of_process().take(answer);
    }
  }
}

void GuardianLink::found(How how, int socket) {
  GuardianNews news;
  {
    const MutexLock lock(mutex_);
    if (state_.how == How::none) news.lasted = Duration{MonotonicClock().now() - state_.since};
    state_ = {how, passed_over_, 0, how == How::started ? child_ : credentials_of(socket).pid};
    news.state = state_;
    changed_.notify_all();
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
    changed_.notify_all();
    if (known) return;
    news.state = state_;
  }
  report_(news);
}

/// One that was started here ends when its connection does.
void GuardianLink::reap() {
  std::erase_if(dying_, [](pid_t one) { return waitpid(one, nullptr, WNOHANG) != 0; });
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
