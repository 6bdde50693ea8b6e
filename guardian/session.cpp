// SPDX-License-Identifier: LGPL-3.0-or-later
#include "session.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "clock.h"
#include "say.h"

namespace mauve::guardian {
namespace {

constexpr std::int64_t kBetweenLooks = 10 * kMillisecond;
/// A look that came later was held up itself: the rest of that time counts against no mauved.
constexpr std::int64_t kOnTime = 2 * kBetweenLooks;
/// A silent stranger keeps no mauved waiting for longer.
constexpr std::int64_t kToGreet = kSecond;
/// Until a process that ends has ended: then its other threads have ended their writes.
constexpr int kToBeGoneMs = 500;

/// The first descriptor that came along; others are closed. -1: none.
int descriptor_in(msghdr& message) {
  int first = -1;
  for (cmsghdr* with = CMSG_FIRSTHDR(&message); with != nullptr;
       with = CMSG_NXTHDR(&message, with)) {
    if (with->cmsg_level != SOL_SOCKET || with->cmsg_type != SCM_RIGHTS) continue;
    for (std::size_t at = CMSG_LEN(0); at + sizeof(int) <= with->cmsg_len; at += sizeof(int)) {
      int one = -1;
      std::memcpy(&one, reinterpret_cast<const char*>(with) + at, sizeof one);
      if (first >= 0) close(one);
      if (first < 0) first = one;
    }
  }
  return first;
}

/// Receives one message, with the descriptor that came along (-1: none). Returns the result of
/// recvmsg(2).
ssize_t receive(int socket, wire::Request& request, int& descriptor) {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> room{};
  iovec part{&request, sizeof request};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  const ssize_t got = recvmsg(socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  descriptor = got > 0 ? descriptor_in(message) : -1;
  return got;
}

/// Looks at the next message without taking it.
bool is_question(int socket, wire::Request& request) {
  iovec part{&request, sizeof request};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  const ssize_t got = recvmsg(socket, &message, MSG_DONTWAIT | MSG_PEEK);
  return got == sizeof request && request.version == wire::kVersion &&
         request.kind == wire::Kind::ask;
}

/// Null when it is none that can be read for ever without a fault.
const wire::Page* map_page(int file) {
  const int seals = fcntl(file, F_GET_SEALS);
  struct stat facts {};
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0 || fstat(file, &facts) != 0) return nullptr;
  if (facts.st_size < static_cast<off_t>(sizeof(wire::Page))) return nullptr;
  void* const page = mmap(nullptr, sizeof(wire::Page), PROT_READ, MAP_SHARED, file, 0);
  return page == MAP_FAILED ? nullptr : static_cast<const wire::Page*>(page);
}

}  // namespace

Session::~Session() {
  if (page_ != nullptr) munmap(const_cast<wire::Page*>(page_), sizeof(wire::Page));
  close(socket_);
}

void Session::run() {
  began_ = looked_ = now();
  Over over = Over::no;
  while (over == Over::no) {
    wait();
    over = look();
  }
  if (over == Over::in_order) {
    say("mauved (process %d) ended in order: its outputs are let go.", peer_.process());
    return;
  }
  if (orders_.count() == 0) {
    say("mauved (process %d) %s; it had no outputs.", peer_.process(), cause_);
    return;
  }
  const std::int64_t noticed = now();
  const Sent sent = send_orders();
  say("mauved (process %d) %s: %u of %u outputs were put into their safe state within %lld ms.",
      peer_.process(), cause_, sent.whole, sent.total,
      static_cast<long long>((now() - noticed) / kMillisecond));
  send_after_it_is_gone();
}

Sent Session::send_orders() {
  return orders_.send([this] { answer_questions(); });
}

/// Devices may take their time: mauved hears meanwhile that its guardian is at work.
void Session::answer_questions() const {
  for (;;) {
    wire::Request request;
    if (!is_question(socket_, request)) return;
    int descriptor = -1;
    if (receive(socket_, request, descriptor) != sizeof request) return;
    answer(request, nullptr);
  }
}

/// The futex speaks for one thread: another one may still be in a write to a device.
void Session::send_after_it_is_gone() {
  pollfd ended{peer_.handle(), POLLIN, 0};
  if (poll(&ended, 1, kToBeGoneMs) == 1) send_orders();
}

/// For a death, at once; for messages and beats until the next look.
void Session::wait() const {
  if (page_ == nullptr || spoilt_) {
    pollfd socket{socket_, POLLIN, 0};
    poll(&socket, 1, static_cast<int>(kBetweenLooks / kMillisecond));
    return;
  }
  const timespec time = duration(kBetweenLooks);
  syscall(SYS_futex, &page_->owner, FUTEX_WAIT, owner_, &time, nullptr, 0);
}

Session::Over Session::look() {
  if (page_ != nullptr) {
    if (!spoilt_ && page_->owner.load(std::memory_order_relaxed) != owner_ && !peer_.gone()) {
      spoilt_ = true;
      say("mauved (process %d) overwrote the page that it shares with its guardian: its end is "
          "noticed some 30 ms later from now on.",
          peer_.process());
    }
  }
  const bool gone = page_ != nullptr && peer_.gone();
  const Over over = serve();  // also of one that is gone: its goodbye may be there
  if (gone && over != Over::in_order) {
    cause_ = "ended without having said so";
    return Over::ended;
  }
  if (over != Over::no) return over;
  if (page_ != nullptr) {
    watch_beats();
  } else if (now() - began_ > kToGreet) {
    cause_ = "did not say who it is";
    return Over::ended;
  }
  return Over::no;
}

Session::Over Session::serve() {
  for (;;) {
    wire::Request request;
    int descriptor = -1;
    const ssize_t got = receive(socket_, request, descriptor);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return Over::no;
    if (got <= 0) {
      cause_ = "closed its connection without having said so";
      return Over::ended;
    }
    if (got != sizeof request || request.version != wire::kVersion) {
      if (descriptor >= 0) close(descriptor);
      answer(request, "another version of mauved and its guardian");
      continue;
    }
    if (const Over over = serve_one(request, descriptor); over != Over::no) return over;
  }
}

/// Takes over `descriptor` in any case.
Session::Over Session::serve_one(const wire::Request& request, int descriptor) {
  const char* refused = nullptr;
  if (request.kind == wire::Kind::hello) {
    refused = greet(request, descriptor);
  } else if (page_ == nullptr) {
    refused = "the first message is a greeting";
  } else if (request.kind == wire::Kind::hold) {
    refused = orders_.hold(request.slot, request.order, std::exchange(descriptor, -1));
  } else if (request.kind == wire::Kind::drop) {
    orders_.drop(request.slot);
  } else if (request.kind == wire::Kind::again) {
    send_orders();
  } else if (request.kind == wire::Kind::bye) {
    orders_.drop_all();
  } else if (request.kind == wire::Kind::ask) {
    // the answer is all that it wants
  } else {
    refused = "no such message";
  }
  if (descriptor >= 0) close(descriptor);
  answer(request, refused);
  return request.kind == wire::Kind::bye ? Over::in_order : Over::no;
}

const char* Session::greet(const wire::Request& request, int page) {
  if (page_ != nullptr) return "it has greeted already";
  if (!peer_.open(socket_, request.thread)) return "/proc does not show the process";
  page_ = map_page(page);
  if (page_ == nullptr) return "the page must be a sealed file in memory";
  owner_ = wire::owner_word(request.thread);
  limit_ = std::int64_t{request.silence_ms} * kMillisecond;
  say("watches mauved (process %d) for its end, and for silence once it beats.", peer_.process());
  return nullptr;
}

void Session::answer(const wire::Request& request, const char* refused) const {
  wire::Answer answer;
  answer.number = request.number;
  answer.done = refused == nullptr ? 1 : 0;
  if (refused != nullptr) std::snprintf(answer.text.data(), answer.text.size(), "%s", refused);
  if (::send(socket_, &answer, sizeof answer, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) return;
}

/// A silence counts as far as this process looked on time itself: a machine that stood still is no
/// silence of mauved.
void Session::watch_beats() {
  const std::int64_t time = now();
  const std::int64_t passed = std::min(time - looked_, kOnTime);
  looked_ = time;
  const std::uint64_t beats = page_->beats.load(std::memory_order_relaxed);
  if (beats != beats_ || beats == 0) {
    if (reported_silent_) say("mauved (process %d) is heard again.", peer_.process());
    reported_silent_ = false;
    silent_ = 0;
    beats_ = beats;
    return;
  }
  const std::uint32_t starved = page_->starved_ms.load(std::memory_order_relaxed);
  silent_ = std::max(silent_ + passed, starved * kMillisecond);
  if (limit_ == 0 || silent_ < limit_ || reported_silent_ || orders_.count() == 0) return;
  reported_silent_ = true;
  const Sent sent = send_orders();
  say("mauved (process %d) was silent for %lld ms: %u of %u outputs were put into their safe "
      "state.",
      peer_.process(), static_cast<long long>(silent_ / kMillisecond), sent.whole, sent.total);
  report_silence(sent);
}

void Session::report_silence(const Sent& sent) const {
  wire::Answer answer;
  answer.kind = wire::Kind::silence;
  answer.done = sent.whole;
  answer.total = sent.total;
  answer.lasted_ms = static_cast<std::uint32_t>(silent_ / kMillisecond);
  if (::send(socket_, &answer, sizeof answer, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) return;
}

}  // namespace mauve::guardian
