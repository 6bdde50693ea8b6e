// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/line_thread.h>

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace mauve::serial {
namespace {

using namespace std::chrono_literals;
using mauve::Errc;
using mauve::refuse;
using mauve::Status;

constexpr int kGlance = 100;                             // ms: does another line want the bytes?
constexpr std::chrono::milliseconds kBetweenLooks{250};  // for a lost device
constexpr int kPause = 10;  // ms: nothing wakes us when there is room again, or a file grows
constexpr std::chrono::milliseconds kFarewell{200};
constexpr std::size_t kStack = 256 * 1024;  // memory is locked: the usual 8 MB would be real

/// Signals are for the threads of mauved, except those that this thread causes itself.
void introduce() {
  prctl(PR_SET_NAME, "mauve-line");
  sigset_t all;
  sigfillset(&all);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigdelset(&all, own);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

/// Then the line comes before ordinary work and before the threads of mauved that serve requests,
/// and after every component of a higher priority.
void raise_priority() {
  const sched_param low{sched_get_priority_min(SCHED_FIFO) + 1};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &low));
}

constexpr std::size_t kHead = 3;  // before a request: how long it is, and after how many orders

/// The bytes of an order, and in the last one how many there are.
using Order = std::array<char, sizeof(std::uint64_t)>;

}  // namespace

struct LineThread::Device {
  std::atomic<std::uint64_t> reader{0};  // whose component ran last
  std::mutex reading;                    // no thread but those of lines ever waits for it
  std::uint64_t tuned = 0;               // whose speed it has
  std::string left;                      // read by one that was the reader until then
  std::atomic<std::uint64_t> order{0};   // the newest, as a word
  std::atomic<std::uint8_t> orders{0};   // their number, which may begin anew

  [[nodiscard]] Order newest() const { return std::bit_cast<Order>(order.load()); }
};

/// The state that all lines of one device share; null for an end that no other line can find.
std::shared_ptr<LineThread::Device> LineThread::device_of(const LineEnd& end) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<Device>, std::less<>> devices;
  const std::string name = end.name();
  if (name.empty()) return nullptr;
  const std::lock_guard lock(mutex);
  std::erase_if(devices, [](const auto& one) { return one.second.expired(); });
  std::shared_ptr<Device> device = devices[name].lock();
  if (device == nullptr) devices[name] = device = std::make_shared<Device>();
  return device;
}

Status LineThread::start(LineEnd& end, std::size_t most_waiting, Lost lost) {
  stop();
  Descriptor bell(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (!bell.open()) return refuse(Errc::system, {}, "cannot create an eventfd for a serial line");
  bell_ = std::move(bell);
  end_ = &end;
  most_waiting_ = most_waiting;
  lost_ = lost;
  stopping_ = asked_ = false;
  hurried_ = followed_ = lost == Lost::opened_to_send;
  device_ = device_of(end);
  open_ = end.number() >= 0;
  losses_ = 0;
  looked_ = {};
  waiting_.drop(waiting_.size());
  request_size_ = 0;
  repeats_ = false;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStack);
  // Ordinary, whichever thread makes it, until a real-time thread uses it.
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  const int error = pthread_create(&thread_, &attributes, &LineThread::enter, this);
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    return refuse(
        Errc::system, {},
        "cannot start the thread of a serial line: " + std::generic_category().message(error),
        "is RLIMIT_MEMLOCK or the number of tasks too small?");
  }
  running_ = true;
  return mauve::ok();
}

void LineThread::stop() {
  if (!running_) return;
  stopping_ = true;
  kick();
  pthread_join(thread_, nullptr);
  running_ = open_ = false;
}

/// The job may be aborted anywhere here: the next job does the rest.
void LineThread::fill(LineBytes& bytes) {
  bool news = filler_.want(bytes);
  follow_the_component();
  if (device_ != nullptr && device_->reader.load(std::memory_order_relaxed) != id()) {
    device_->reader.store(id(), std::memory_order_release);
    news = true;
  }
  if (news) kick();
}

bool LineThread::send(std::string_view bytes) {
  const std::array<char, kHead> head{static_cast<char>(bytes.size() % 256U),
                                     static_cast<char>(bytes.size() / 256U),
                                     static_cast<char>(orders())};
  if (waiting_.size() + head.size() + bytes.size() > most_waiting_) return false;
  if (!waiting_.put(head, bytes)) return false;
  follow_the_component();
  kick();
  return true;
}

/// In this sequence: a thread that sees the new number also sees the new order.
void LineThread::overrule(std::string_view order) {
  if (device_ == nullptr) return;
  Order packed{};
  packed.back() = static_cast<char>(order.copy(packed.data(), packed.size() - 1));
  device_->order = std::bit_cast<std::uint64_t>(packed);
  ++device_->orders;
}

std::uint8_t LineThread::orders() const {
  return device_ != nullptr ? device_->orders.load() : std::uint8_t{0};
}

bool LineThread::reopen() {
  if (open()) return true;
  asked_.store(true, std::memory_order_release);
  kick();
  return false;
}

/// Checks once whether a real-time thread uses the line.
void LineThread::follow_the_component() {
  if (std::exchange(followed_, true)) return;
  hurried_ = sched_getscheduler(0) == SCHED_FIFO;
}

/// Bounded: no write to an eventfd waits for its reader.
void LineThread::kick() const {
  const std::uint64_t one = 1;
  static_cast<void>(::write(bell_.number(), &one, sizeof one));
}

void* LineThread::enter(void* self) {
  introduce();
  static_cast<LineThread*>(self)->run();
  return nullptr;
}

void LineThread::run() {
  while (!stopping_.load(std::memory_order_acquire)) {
    if (hurried_.exchange(false)) raise_priority();
    filler_.choose();
    const bool looks = lost_ == Lost::looked_for && !open() &&
                       std::chrono::steady_clock::now() - looked_ >= kBetweenLooks;
    if (asked_.exchange(false) || looks) open_again();
    write_out();
    read_in();
    wait();
  }
  send_rest();
  filler_.end();
}

bool LineThread::reads() const {
  return open() && filler_.bytes() != nullptr &&
         (device_ == nullptr || device_->reader.load(std::memory_order_acquire) == id());
}

/// Gives the device the settings of this end; only when the line is used, so that an unused line
/// changes nothing.
void LineThread::tune() {
  if (device_ != nullptr && device_->tuned != id() && end_->tune()) device_->tuned = id();
}

/// Waiting bytes were for the device that is gone.
void LineThread::open_again() {
  if (open()) return;
  looked_ = std::chrono::steady_clock::now();
  drop_waiting();
  const bool opened = end_->reopen();
  error_ = opened ? 0 : errno;
  idle_ = false;
  open_.store(opened, std::memory_order_release);
}

void LineThread::read_in() {
  while (reads()) {
    const std::span<char> room = filler_.bytes()->ring.room();
    if (room.empty()) return;
    const std::ptrdiff_t count = read_some(room);
    if (count < 0) return lose();
    if (count == 0) return;
    idle_ = false;
    filler_.bytes()->ring.filled(static_cast<std::size_t>(count));
    if (report_received_) report_received_(static_cast<std::size_t>(count));
  }
}

/// Nothing, when another line became the reader meanwhile.
std::ptrdiff_t LineThread::read_some(std::span<char> room) {
  if (device_ == nullptr) return end_->read(room);
  const std::lock_guard lock(device_->reading);
  if (!reads()) return 0;
  std::string& left = device_->left;
  if (!left.empty()) {
    const std::size_t count = left.copy(room.data(), room.size());
    left.erase(0, count);
    return static_cast<std::ptrdiff_t>(count);
  }
  tune();
  const std::ptrdiff_t count = end_->read(room);
  if (count <= 0 || reads()) return count;
  left.assign(room.data(), static_cast<std::size_t>(count));  // for the new reader of the device
  return 0;
}

/// Is there something to send?
bool LineThread::next_request() {
  if (request_size_ > 0) return true;
  if (waiting_.size() == 0) return false;
  const auto digit = [this](std::size_t at) {
    return static_cast<unsigned char>(waiting_.there(at).front());
  };
  request_size_ = kHead + digit(0) + 256U * digit(1);
  request_sent_ = kHead;
  request_orders_ = digit(2);
  return true;
}

bool LineThread::overruled() const { return !repeats_ && request_orders_ != orders(); }

/// An order that came while it went out may have gone out before it: then that does once more.
void LineThread::end_request() {
  const bool again = request_sent_ > kHead && overruled();
  if (!repeats_) waiting_.drop(request_size_);
  repeats_ = again;
  request_size_ = again ? static_cast<std::size_t>(device_->newest().back()) : 0;
  request_sent_ = 0;
}

void LineThread::write_out() {
  bool reopened = false;
  while (next_request()) {
    if (!open() && lost_ == Lost::opened_to_send && !std::exchange(reopened, true)) {
      error_ = end_->reopen() ? 0 : errno;
      open_ = end_->number() >= 0;
    }
    if (!open()) return drop_waiting();
    if (request_sent_ == kHead && overruled()) {
      end_request();
      continue;
    }
    const std::ptrdiff_t count = write_some();
    if (count == 0) return;
    if (count < 0) {
      lose();
      continue;
    }
    request_sent_ += static_cast<std::size_t>(count);
    if (request_sent_ < request_size_) continue;
    end_request();
    reopened = false;  // requests sent meanwhile may meet another loss
  }
}

std::ptrdiff_t LineThread::write_some() {
  const Order order = repeats_ ? device_->newest() : Order{};
  std::span<const char> rest =
      repeats_ ? std::span(order).subspan(request_sent_) : waiting_.there(request_sent_);
  rest = rest.first(std::min(rest.size(), request_size_ - request_sent_));
  // A reader may hold the lock for a long time, so a line for emergencies writes without it, at any
  // speed.
  std::unique_lock<std::mutex> lock;
  if (device_ != nullptr && lost_ != Lost::opened_to_send) {
    lock = std::unique_lock(device_->reading);
    tune();
  }
  return end_->write({rest.data(), rest.size()});
}

void LineThread::lose() {
  error_ = errno;
  end_->close();
  request_sent_ = repeats_ ? 0 : kHead;  // the next device has heard nothing of it
  losses_.fetch_add(1, std::memory_order_relaxed);
  open_.store(false, std::memory_order_release);
}

void LineThread::drop_waiting() {
  if (!next_request()) return;
  waiting_.drop(waiting_.size());
  request_size_ = 0;
  repeats_ = false;
  if (report_unsent_) report_unsent_();
}

void LineThread::wait() {
  const bool filling = reads();
  const bool full = filling && filler_.bytes()->ring.room().empty();
  pollfd bell{bell_.number(), POLLIN, 0};
  pollfd line{-1, 0, 0};
  if (filling && !full && !idle_) line.events = POLLIN;
  if (open() && next_request()) line.events |= POLLOUT;
  // Nobody reads, so only its end counts: a guarded device must be found again.
  const bool awaits_end = lost_ == Lost::looked_for && open() && line.events == 0 && !idle_;
  if (line.events != 0 || awaits_end) line.fd = end_->number();
  std::array<pollfd, 2> both{bell, line};
  const bool glances = filler_.bytes() != nullptr || (lost_ == Lost::looked_for && !open());
  const int longest = full || idle_ ? kPause : glances ? kGlance : -1;
  ::poll(both.data(), both.size(), longest);
  idle_ = false;
  if ((both[0].revents & POLLIN) != 0) {
    std::uint64_t rings = 0;
    static_cast<void>(::read(bell_.number(), &rings, sizeof rings));
  } else if (lost_ == Lost::looked_for && (both[1].revents & (POLLHUP | POLLERR)) != 0) {
    errno = EIO;  // a read of a terminal that was hung up returns nothing, and no error
    lose();
  } else if (both[1].revents != 0 && (both[1].revents & POLLOUT) == 0) {
    idle_ = true;  // unless it has something to read
  }
}

void LineThread::send_rest() {
  const auto until = std::chrono::steady_clock::now() + kFarewell;
  for (write_out(); next_request() && std::chrono::steady_clock::now() < until; write_out()) {
    pollfd line{end_->number(), POLLOUT, 0};
    ::poll(&line, 1, kPause);
  }
}

}  // namespace mauve::serial
