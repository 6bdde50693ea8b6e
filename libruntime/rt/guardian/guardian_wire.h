// SPDX-License-Identifier: LGPL-3.0-or-later
/// The protocol between mauved and its guardian (guardian/README.md): messages on a SOCK_SEQPACKET
/// socket between processes of one machine and one build, and a page that both see.
#pragma once

#include <linux/futex.h>
#include <sys/types.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace mauve::rt::guardian {

/// Of messages and page; another version is refused.
inline constexpr std::uint32_t kVersion = 3;
inline constexpr std::size_t kMostOutputs = 32;
inline constexpr std::size_t kMostBytes = 256;
/// All orders must have gone out this long after the end was noticed, in milliseconds.
inline constexpr std::uint32_t kMostTimeMs = 100;

/// Lies in a sealed memfd of mauved. The guardian maps it for reading only, and believes nothing of
/// it without asking the kernel.
struct Page {
  std::uint32_t version;
  std::uint32_t unused;
  void* entry;                       ///< of a robust futex list (set_robust_list(2)), mauved's own
  std::atomic<std::uint32_t> owner;  ///< that futex: the thread, FUTEX_WAITERS, FUTEX_OWNER_DIED
  std::atomic<std::uint32_t>
      starved_ms;                    ///< so long a guarded component gets no processor; 0: none
  std::atomic<std::uint64_t> beats;  ///< rises while components are served
};
static_assert(std::is_standard_layout_v<Page>);

/// The value of Page::owner while that thread lives.
[[nodiscard]] constexpr std::uint32_t owner_word(pid_t thread) {
  return static_cast<std::uint32_t>(thread) | FUTEX_WAITERS;
}

/// The bytes that put an output into its safe state.
struct Order {
  std::array<char, 64> name{};  ///< for the log; ends with a zero
  std::array<std::uint8_t, kMostBytes> bytes{};
  std::uint32_t size = 0;         ///< of these, 1 to kMostBytes
  std::uint32_t times = 1;        ///< sent so often, 1 to 10
  std::uint32_t apart_us = 0;     ///< from one time to the next; all of them within kMostTimeMs
  std::uint32_t drop_unsent = 0;  ///< 1: of a terminal, first drops unsent bytes
};

enum class Kind : std::uint32_t {
  hello,    ///< mauved; with the page
  hold,     ///< mauved: hold this order; with the descriptor
  drop,     ///< mauved: hold it no more
  again,    ///< mauved: after a silence all components stand; send the orders once more
  bye,      ///< mauved ends in order, or has another guardian: nothing is to be sent
  ask,      ///< mauved: does it still serve?
  answer,   ///< guardian, to each of the above
  silence,  ///< guardian: mauved was silent, the orders were sent
};

/// From mauved.
struct Request {
  std::uint32_t version = kVersion;
  Kind kind = Kind::hello;
  std::uint32_t number = 0;  ///< of the request, 0 of hello and ask; the answer has the same
  std::uint32_t slot = 0;    ///< of the order, below kMostOutputs
  std::int32_t thread = 0;   ///< hello: the owner in the page
  std::uint32_t silence_ms =
      0;  ///< hello: so long without a beat is an end; 0: beats are not watched
  Order order;
};

/// From the guardian.
struct Answer {
  Kind kind = Kind::answer;
  std::uint32_t number = 0;
  std::uint32_t done = 0;       ///< answer: 1 when it was done. silence: orders that went out whole
  std::uint32_t total = 0;      ///< silence: orders that it holds
  std::uint32_t lasted_ms = 0;  ///< silence: how long it had lasted when it was noticed
  std::array<char, 160> text{};  ///< why it was not done; ends with a zero
};

}  // namespace mauve::rt::guardian
