// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/line_requests.h>

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

namespace mauve::serial {
namespace {

/// Before a request: how long it is, and after how many orders of both kinds.
constexpr std::size_t kHead = 4;

}  // namespace

/// In this sequence: a thread that sees the new number also sees the new order.
void LineOrders::give(std::string_view order) {
  Order packed{};
  packed.back() = static_cast<char>(order.copy(packed.data(), packed.size() - 1));
  newest_ = std::bit_cast<std::uint64_t>(packed);
  ++number_;
}

LineOrders::Order LineOrders::newest() const { return std::bit_cast<Order>(newest_.load()); }

void LineRequests::begin(std::shared_ptr<const LineOrders> orders, std::size_t most_waiting,
                         const LineEnd* end) {
  orders_ = std::move(orders);
  end_ = end;
  most_waiting_ = most_waiting;
  drop();
}

bool LineRequests::put(std::string_view request) {
  if (waiting_.size() + kHead + request.size() > most_waiting_) return false;
  if (request.empty()) return true;
  const std::array<char, kHead> head{
      static_cast<char>(request.size() % 256U), static_cast<char>(request.size() / 256U),
      static_cast<char>(orders_->number()), static_cast<char>(by_end())};
  return waiting_.put(head, request);
}

std::string_view LineRequests::next() {
  while (size_ > 0 || take()) {
    if (written_ > 0 || !is_overruled()) {
      const std::span<const char> rest = repeats_
                                             ? std::span(std::as_const(order_)).subspan(written_)
                                             : waiting_.there(kHead + written_);
      return {rest.data(), std::min(rest.size(), size_ - written_)};
    }
    end_request();
  }
  return {};
}

/// The first request that waits goes out now.
bool LineRequests::take() {
  if (waiting_.size() == 0) return false;
  const auto digit = [this](std::size_t at) {
    return static_cast<unsigned char>(waiting_.there(at).front());
  };
  size_ = digit(0) + 256U * digit(1);
  number_ = digit(2);
  number_by_end_ = digit(3);
  repeats_ = false;
  return true;
}

bool LineRequests::written(std::size_t count) {
  written_ += count;
  if (written_ < size_) return false;
  end_request();
  return true;
}

/// An order that came while a request or an order went out may have gone out before it: then the
/// newest order goes out next. An order that has not begun is followed by a newer one, too. The end
/// repeats its own orders.
void LineRequests::end_request() {
  overruled_ = written_ > 0 && is_overruled();
  const std::uint8_t newest = orders_->number();
  const bool follows = newest != number_ && (repeats_ || written_ > 0);
  if (!repeats_) waiting_.drop(kHead + size_);
  repeats_ = follows;
  number_ = newest;
  number_by_end_ = by_end();
  order_ = orders_->newest();
  size_ = follows ? static_cast<std::size_t>(order_.back()) : 0;
  written_ = 0;
}

bool LineRequests::drop() {
  const bool some = size_ > 0 || waiting_.size() > 0;
  waiting_.drop(waiting_.size());
  size_ = written_ = 0;
  repeats_ = false;
  return some;
}

}  // namespace mauve::serial
