// SPDX-License-Identifier: LGPL-3.0-or-later
/// Peers that a program writes by hand: the raw loop, a mutex, a triple buffer.
#include <atomic>
#include <cstring>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/support/raw.h"

namespace bench::peers {
namespace {

/// One memory for both threads, without protection. The reader's releases lie half a period behind
/// those of the writer, on one CPU; nothing else keeps the two apart.
class Raw : public Peer {
 public:
  explicit Raw(std::size_t size) : value_(size) {}
  void write(const void* data) override {
    std::memcpy(value_.data(), data, value_.size());
    written_.store(true, std::memory_order_release);
  }
  void read(void* into) override {
    if (!written_.load(std::memory_order_acquire)) return;
    std::memcpy(into, value_.data(), value_.size());
  }

 private:
  std::vector<std::byte> value_;
  std::atomic<bool> written_{false};
};

template <typename Way>
class Around : public Peer {
 public:
  explicit Around(std::size_t size) : way_(size) {}
  void write(const void* data) override { way_.write(data); }
  void read(void* into) override { way_.read(into); }

 private:
  Way way_;
};

}  // namespace

std::unique_ptr<Peer> make_raw(std::size_t size) { return std::make_unique<Raw>(size); }
std::unique_ptr<Peer> make_pi_mutex(std::size_t size) {
  return std::make_unique<Around<RawPiMutex>>(size);
}
std::unique_ptr<Peer> make_triple_buffer(std::size_t size) {
  return std::make_unique<Around<RawTripleBuffer>>(size);
}

}  // namespace bench::peers
