// SPDX-License-Identifier: LGPL-3.0-or-later
/// The requests that wait to be sent over a line, and the order that overrules them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include <mauve/serial/byte_ring.h>
#include <mauve/serial/serial_port.h>

namespace mauve::serial {

/// The newest order for a device, which all lines of the device share. Any thread may use it.
class LineOrders {
 public:
  /// The bytes of an order, and in the last one how many there are.
  using Order = std::array<char, sizeof(std::uint64_t)>;

  /// It overrules all requests that were made before; 7 bytes of it at most. [rt]
  void give(std::string_view order);
  /// How many there were, which begins anew after 255. Read it before newest(). [rt]
  [[nodiscard]] std::uint8_t number() const { return number_.load(); }
  [[nodiscard]] Order newest() const;  ///< [rt]

 private:
  std::atomic<std::uint64_t> newest_{0};
  std::atomic<std::uint8_t> number_{0};
};

/// Requests from the thread that sends to the thread that writes. A request goes out whole, unless
/// an order came after it. One that has not begun by then is dropped. One that has begun is
/// followed by the order, since the order may have gone out before its end.
class LineRequests {
 public:
  /// None waits. At most `most_waiting` bytes may wait, counted with four more for each request.
  /// `end`, if there is one, counts further orders, which it sends itself.
  void begin(std::shared_ptr<const LineOrders> orders, std::size_t most_waiting,
             const LineEnd* end = nullptr);
  /// All of it waits from now on, or nothing and false: too much waits already. [rt]
  bool put(std::string_view request);

  // The side of the thread that writes.

  /// The next bytes to write; empty: no request waits. They are there until the next call.
  [[nodiscard]] std::string_view next();
  /// So many bytes of next() are written; true: these were the last ones of the request.
  bool written(std::size_t count);
  /// The request that was written last was overruled while it went out.
  [[nodiscard]] bool was_overruled() const { return overruled_; }
  /// The device that heard a part of the request is gone: the next one hears all of it.
  void again() { written_ = 0; }
  /// No request waits any more; returns whether one did.
  bool drop();

 private:
  [[nodiscard]] std::uint8_t by_end() const {
    return end_ == nullptr ? std::uint8_t{0} : end_->times_overruled();
  }
  [[nodiscard]] bool is_overruled() const {
    return number_ != orders_->number() || number_by_end_ != by_end();
  }
  bool take();
  void end_request();

  std::shared_ptr<const LineOrders> orders_;
  const LineEnd* end_ = nullptr;
  std::size_t most_waiting_ = 0;
  ByteRing<16'384> waiting_;  // requests, each after its head

  // Of the request that goes out.
  std::size_t size_ = 0;     // 0: there is none
  std::size_t written_ = 0;  // bytes of it
  std::uint8_t number_ = 0;  // of the order that was the newest when it was made
  std::uint8_t number_by_end_ = 0;
  bool overruled_ = false;  // the one before was, while it went out
  bool repeats_ = false;    // it is an order that follows a request, and not in the ring
  LineOrders::Order order_{};
};

}  // namespace mauve::serial
