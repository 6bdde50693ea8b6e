// SPDX-License-Identifier: LGPL-3.0-or-later
/// One mauved, from its first message to its end.
#pragma once

#include <cstdint>

#include "orders.h"
#include "peer.h"

namespace mauve::guardian {

/// Watches the process at the other end of a socket, and sends its orders when it ends without
/// notice, or falls silent. One thread; takes no memory.
class Session {
 public:
  /// Of a SOCK_SEQPACKET socket, which the session closes.
  explicit Session(int socket) : socket_(socket) {}
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Until it is over.
  void run();

 private:
  enum class Over : std::uint8_t { no, in_order, ended };

  void wait() const;
  [[nodiscard]] Over look();
  [[nodiscard]] Over serve();
  [[nodiscard]] Over serve_one(const wire::Request& request, int descriptor);
  [[nodiscard]] const char* greet(const wire::Request& request, int page);
  void answer(const wire::Request& request, const char* refused) const;
  void watch_beats();
  Sent send_orders();
  void answer_questions() const;
  void send_after_it_is_gone();
  void report_silence(const Sent& sent) const;

  const int socket_;
  Peer peer_;
  Orders orders_;
  const wire::Page* page_ = nullptr;  // null: it has not greeted yet
  std::uint32_t owner_ = 0;           // the value of its futex while it lives
  mutable bool spoilt_ = false;       // the page is not believed any more
  std::int64_t limit_ = 0;            // a silence that is an end; 0: none is
  std::uint64_t beats_ = 0;           // the last that was seen; 0: none yet
  std::int64_t looked_ = 0;           // when
  std::int64_t began_ = 0;
  std::int64_t silent_ = 0;  // for so long, as far as this process itself was on time
  bool reported_silent_ = false;
  const char* cause_ = "";
};

}  // namespace mauve::guardian
