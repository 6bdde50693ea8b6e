// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/line_bytes.h>

#include <chrono>
#include <thread>
#include <utility>

namespace mauve::serial {
namespace {

using namespace std::chrono_literals;

std::uint64_t look(std::uint64_t& mark) {
  return std::atomic_ref(mark).load(std::memory_order_acquire);
}
void store(std::uint64_t& mark, std::uint64_t value) {
  std::atomic_ref(mark).store(value, std::memory_order_release);
}
bool replace(std::uint64_t& mark, std::uint64_t seen, std::uint64_t value) {
  return std::atomic_ref(mark).compare_exchange_strong(seen, value);
}

}  // namespace

bool LineFiller::want(LineBytes& bytes) {
  if (const auto here = reinterpret_cast<std::uintptr_t>(&bytes); bytes.home != here) {
    store(bytes.filler, 0);
    bytes.home = here;
  }
  store(bytes.wanted, id());
  return offer(bytes);
}

/// Bytes that no line has, or that an aborted job had offered by half. The offer is
/// read before the mark: when the thread took the offer, the mark is another by then.
bool LineFiller::offer(LineBytes& bytes) {
  const bool offered = offered_.load(std::memory_order_acquire) == &bytes;
  const std::uint64_t filler = look(bytes.filler);
  if (filler != 0 && filler != id()) return false;
  if (filler == id() && offered) return true;  // did the job before come as far as to wake it?
  store(bytes.filler, id());
  LineBytes* const earlier = offered_.exchange(&bytes);
  if (earlier != nullptr && earlier != &bytes) replace(earlier->filler, id(), 0);
  return true;
}

void LineFiller::empty_handed(LineBytes& bytes) const {
  store(bytes.wanted, 0);
  if (bytes.home != reinterpret_cast<std::uintptr_t>(&bytes)) return;
  replace(bytes.filler, id(), 0);  // a job was aborted in want()
  while (look(bytes.filler) != 0) std::this_thread::sleep_for(1ms);
}

/// The mark alone states whether this line may still take the offer.
void LineFiller::choose() {
  if (LineBytes* offered = offered_.load(std::memory_order_acquire)) {
    if (replace(offered->filler, id(), own())) {
      let_go();
      filled_ = offered;
    }
    offered_.compare_exchange_strong(offered, nullptr);
  }
  if (filled_ != nullptr && look(filled_->wanted) != id()) let_go();
}

void LineFiller::end() {
  if (LineBytes* const offered = offered_.exchange(nullptr)) replace(offered->filler, id(), 0);
  let_go();
}

/// This line does not touch the bytes after it.
void LineFiller::let_go() {
  LineBytes* const bytes = std::exchange(filled_, nullptr);
  if (bytes != nullptr) store(bytes->filler, 0);
}

}  // namespace mauve::serial
