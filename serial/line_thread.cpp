// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/line_thread.h>

#include <poll.h>

#include <cerrno>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include <mauve/guarded.h>

namespace mauve::serial {
namespace {

using namespace std::chrono_literals;
using mauve::Status;

constexpr int kGlance = 100;                             // ms: does another line want the bytes?
constexpr std::chrono::milliseconds kBetweenLooks{250};  // for a lost device
constexpr int kPause = 10;  // ms: nothing wakes us when there is room again, or a file grows
constexpr std::chrono::milliseconds kFarewell{200};
constexpr std::chrono::seconds kUnused{3};
constexpr unsigned kBetweenChecks = 256;  // uses of the line: a check is a system call

}  // namespace

struct LineThread::Device {
  std::atomic<std::uint64_t> reader{0};  // whose component ran last
  std::mutex reading;                    // no thread but those that read ever waits for it
  std::string left;                      // read by one that was the reader until then
  std::mutex tuning;                     // no thread that holds it reads or polls
  std::atomic<std::uint64_t> tuned{0};   // whose speed it has, set under `tuning`; 0: nobody's
  LineOrders orders;
};

/// The state that all lines of one device share. An end that no other line can find has its own.
std::shared_ptr<LineThread::Device> LineThread::device_of(const LineEnd& end) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<Device>, std::less<>> devices;
  const std::string name = end.name();
  if (name.empty()) return std::make_shared<Device>();
  const std::lock_guard lock(mutex);
  std::erase_if(devices, [](const auto& one) { return one.second.expired(); });
  std::shared_ptr<Device> device = devices[name].lock();
  if (device == nullptr) devices[name] = device = std::make_shared<Device>();
  return device;
}

Status LineThread::start(LineEnd& end, std::size_t most_waiting, Lost lost) {
  stop();
  end_ = &end;
  lost_ = lost;
  stopping_ = asked_ = false;
  uses_ = seen_uses_ = 0;
  used_ = std::chrono::steady_clock::now();
  followed_ = lost == Lost::opened_to_send;
  device_ = device_of(end);
  open_ = end.number() >= 0;
  losses_ = 0;
  failed_ = 0;
  looked_ = {};
  requests_.begin(std::shared_ptr<const LineOrders>(device_, &device_->orders), most_waiting, &end);
  Status begun = mauve::ok();
  if (lost != Lost::opened_to_send) {
    begun = reader_.begin("mauve-line-in", [this] { read_until_the_end(); });
  }
  if (begun && most_waiting > 0) {
    begun = writer_.begin("mauve-line-out", [this] { write_until_the_end(); });
  }
  if (!begun) stop();
  if (followed_) writer_.hurry();
  return begun;
}

void LineThread::stop() {
  stopping_ = true;
  writer_.call();
  reader_.call();
  writer_.join();
  reader_.join();
  open_ = false;
  if (device_ == nullptr) return;
  for (auto* const mark : {&device_->tuned, &device_->reader}) {
    std::uint64_t its = id();
    mark->compare_exchange_strong(its, 0);  // the next line may be at this address
  }
}

/// The job may be aborted anywhere here: the next job does the rest.
void LineThread::fill(LineBytes& bytes) {
  if (device_ == nullptr) return;
  bool news = filler_.want(bytes);
  follow_the_component();
  if (device_->reader.load(std::memory_order_relaxed) != id()) {
    device_->reader.store(id(), std::memory_order_release);
    news = true;
  }
  if (news) reader_.call();
}

bool LineThread::send(std::string_view bytes) {
  if (mauve::is_abandoned() || !requests_.put(bytes)) return false;
  follow_the_component();
  writer_.call();
  return true;
}

void LineThread::overrule(std::string_view order) {
  if (device_ != nullptr) device_->orders.give(order);
}

bool LineThread::reopen() {
  if (open()) return true;
  asked_.store(true, std::memory_order_release);
  reader_.call();
  return false;
}

/// Checks in the first job, and then now and then, whether a real-time thread uses the line.
void LineThread::follow_the_component() {
  if (uses_.fetch_add(1, std::memory_order_relaxed) % kBetweenChecks != 0 || followed_) return;
  if (!CalledThread::caller_is_real_time()) return;
  writer_.hurry();
  reader_.hurry();
  followed_ = true;  // last: the job may be aborted
}

void LineThread::read_until_the_end() {
  while (!stopping_.load(std::memory_order_acquire)) {
    filler_.choose();
    if (const int error = failed_; error != 0 && open()) lose(error);
    const auto now = std::chrono::steady_clock::now();
    const unsigned uses = uses_.load(std::memory_order_relaxed);
    if (std::exchange(seen_uses_, uses) != uses) used_ = now;
    // Its component is stopped or gone, and another one has the device now. It looks for the device
    // no more until a job uses the line.
    const bool unused = now - used_ >= kUnused;
    if (unused && open() && end_->is_awaited()) lose(kOfAnotherComponent);
    const bool gave_way = unused && error_ == kOfAnotherComponent;
    const bool soon = now - looked_ < kBetweenLooks;
    const bool looks = lost_ == Lost::looked_for && !open() && !soon && !gave_way;
    const bool may_ask = error_ != kNotGuarded || !soon;  // each try opens the device
    if ((may_ask && asked_.exchange(false)) || looks) open_again();
    read_in();
    wait_for_bytes();
  }
  filler_.end();
}

bool LineThread::reads() const {
  return open() && filler_.bytes() != nullptr &&
         device_->reader.load(std::memory_order_acquire) == id();
}

/// Gives the device the settings of this end; only when the line is used, so that an unused line
/// changes nothing.
void LineThread::tune() {
  if (device_->tuned != id() && end_->tune()) device_->tuned = id();
}

/// Waiting bytes were for the device that is gone.
void LineThread::open_again() {
  if (open()) return;
  looked_ = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(output_);
    drop_waiting();
  }
  {
    const std::lock_guard lock(device_->reading);
    device_->left.clear();
  }
  const bool opened = end_->reopen();
  device_->tuned = 0;  // whichever speed it has now, the line that uses it sets its own
  error_ = opened ? 0 : errno;
  if (opened) used_ = looked_;
  failed_ = 0;
  idle_ = false;
  open_.store(opened, std::memory_order_release);
}

void LineThread::read_in() {
  while (reads()) {
    const std::span<char> room = filler_.bytes()->ring.room();
    if (room.empty()) return;
    const std::ptrdiff_t count = read_some(room);
    if (count < 0) return lose(errno);
    if (count == 0) return;
    idle_ = false;
    filler_.bytes()->ring.filled(static_cast<std::size_t>(count));
    if (report_received_) report_received_(static_cast<std::size_t>(count));
  }
}

/// Nothing, when another line became the reader meanwhile.
std::ptrdiff_t LineThread::read_some(std::span<char> room) {
  const std::lock_guard lock(device_->reading);
  if (!reads()) return 0;
  std::string& left = device_->left;
  if (!left.empty()) {
    const std::size_t count = left.copy(room.data(), room.size());
    left.erase(0, count);
    return static_cast<std::ptrdiff_t>(count);
  }
  if (device_->tuned != id()) {
    const std::lock_guard alone(device_->tuning);
    tune();
  }
  const std::ptrdiff_t count = end_->read(room);
  if (count <= 0 || reads()) return count;
  left.assign(room.data(), static_cast<std::size_t>(count));  // for the new reader of the device
  return 0;
}

void LineThread::wait_for_bytes() {
  const bool filling = reads();
  const bool full = filling && filler_.bytes()->ring.room().empty();
  pollfd line{-1, 0, 0};
  if (filling && !full && !idle_) line.events = POLLIN;
  // Nobody reads, so only its end counts. A guarded device must be found again, and any device that
  // is gone and kept open gets another name when it comes back.
  const bool awaits_end =
      open() && line.events == 0 && !idle_ && (lost_ == Lost::looked_for || !filling);
  if (line.events != 0 || awaits_end) line.fd = end_->number();
  const bool glances = open() || filler_.bytes() != nullptr || lost_ == Lost::looked_for;
  const int longest = full || idle_ ? kPause : glances ? kGlance : -1;
  const bool called = reader_.wait(longest, &line);
  idle_ = false;
  if (called) return;
  const bool hung_up = (line.revents & (POLLHUP | POLLERR)) != 0;
  if (hung_up && (lost_ == Lost::looked_for || awaits_end)) {
    lose(EIO);  // a read of a terminal that was hung up returns nothing, and no error
  } else if (line.revents != 0) {
    idle_ = true;  // unless it has something to read
  }
}

/// The thread that reads calls it, if there is one: the ring has all that this thread read before.
void LineThread::lose(int error) {
  {
    const std::lock_guard lock(output_);
    mark_lost(error);
  }
  end_->close();
}

/// Under `output_`: nothing is written from now on. The next device has heard nothing of the
/// request that goes out.
void LineThread::mark_lost(int error) {
  error_ = error;
  requests_.again();
  losses_.fetch_add(1, std::memory_order_relaxed);
  open_.store(false, std::memory_order_release);
}

/// Under `output_`.
void LineThread::drop_waiting() {
  if (requests_.drop() && report_unsent_) report_unsent_();
}

void LineThread::write_until_the_end() {
  while (!stopping_.load(std::memory_order_acquire)) {
    const bool rest = write_out();
    writer_.wait(rest ? kPause : kGlance);  // the job that sent may be aborted before it calls
  }
  const auto until = std::chrono::steady_clock::now() + kFarewell;
  while (write_out() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(kPause));
  }
}

/// True: the device has no room for all of it.
bool LineThread::write_out() {
  const std::lock_guard lock(output_);
  const bool opens = lost_ == Lost::opened_to_send;
  bool reopened = false;
  for (auto bytes = requests_.next(); !bytes.empty(); bytes = requests_.next()) {
    if (!open() && opens && !std::exchange(reopened, true)) {
      error_ = end_->reopen() ? 0 : errno;
      open_ = end_->number() >= 0;
    }
    if (!open() || failed_ != 0) {
      drop_waiting();
      return false;
    }
    const std::ptrdiff_t count = write_some(bytes);
    if (count == 0) return true;
    if (count > 0) {
      // A request that was sent meanwhile may meet another loss.
      if (requests_.written(static_cast<std::size_t>(count))) {
        reopened = false;
        if (requests_.was_overruled()) end_->repeat_order();
      }
    } else if (opens) {
      mark_lost(errno);
      end_->close();
    } else {
      failed_ = errno != 0 ? errno : EIO;
      reader_.call();
    }
  }
  return false;
}

/// A line for emergencies writes at any speed, and waits for no other line that tunes the device.
std::ptrdiff_t LineThread::write_some(std::string_view bytes) {
  if (lost_ == Lost::opened_to_send) return end_->write(bytes);
  const std::lock_guard lock(device_->tuning);
  tune();
  return end_->write(bytes);
}

}  // namespace mauve::serial
