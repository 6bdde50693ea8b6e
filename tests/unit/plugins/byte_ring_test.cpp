// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <thread>
#include <type_traits>

#include <mauve/serial/byte_ring.h>

namespace {

using mauve::serial::ByteRing;
static_assert(std::is_trivially_copyable_v<ByteRing<16>>, "part of states");

template <std::size_t kSize>
std::string take(ByteRing<kSize>& ring) {
  std::string all;
  for (auto there = ring.there(); !there.empty(); there = ring.there()) {
    all.append(there.begin(), there.end());
    ring.drop(there.size());
  }
  return all;
}

TEST(ByteRing, KeepsTheOrderAroundItsEnd) {
  ByteRing<8> ring;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(ring.put(std::string_view("abcde")));
    EXPECT_EQ(take(ring), "abcde");
  }
}

TEST(ByteRing, TakesAllOfARequestOrNothing) {
  ByteRing<8> ring;
  ASSERT_TRUE(ring.put(std::string_view("12345")));
  EXPECT_FALSE(ring.put(std::string_view("6789")));
  EXPECT_TRUE(ring.put(std::string_view("678")));
  EXPECT_TRUE(ring.room().empty());

  EXPECT_EQ(take(ring), "12345678");
  EXPECT_EQ(ring.room().size(), 8U);
}

TEST(ByteRing, BringsEveryByteFromOneThreadToAnother) {
  constexpr unsigned kBytes = 200'000;
  ByteRing<64> ring;
  std::thread writer([&] {
    for (unsigned sent = 0; sent < kBytes;) {
      const auto room = ring.room();
      std::size_t count = 0;
      while (count < room.size() && sent < kBytes) {
        room[count++] = static_cast<char>(sent++ % 251);
      }
      ring.filled(count);
      if (count == 0) std::this_thread::yield();
    }
  });
  unsigned wrong = 0;
  for (unsigned seen = 0; seen < kBytes;) {
    const auto there = ring.there();
    for (const char byte : there) wrong += byte == static_cast<char>(seen++ % 251) ? 0U : 1U;
    ring.drop(there.size());
    if (there.empty()) std::this_thread::yield();
  }
  writer.join();

  EXPECT_EQ(wrong, 0U);
}

}  // namespace
