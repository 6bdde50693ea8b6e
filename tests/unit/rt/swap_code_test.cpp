// SPDX-License-Identifier: LGPL-3.0-or-later
/// A swap is short because its code is fetched beforehand, together, from one page or two.
#include <gtest/gtest.h>
#include <unistd.h>

#include "rt/process/cache.h"

namespace mauve::rt {
namespace {

/// Instructions of arm64 have four bytes each, so there the code needs a second page.
#if defined(__aarch64__)
constexpr std::size_t kPages = 2;
#else
constexpr std::size_t kPages = 1;
#endif

TEST(SwapCode, FitsOntoItsPages) {
  EXPECT_GT(swap_code_size(), 1000u) << "the code lies in its section";
  EXPECT_LE(swap_code_size(), kPages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)))
      << "a function with the mark MAUVE_RUNS_AT_A_SWAP has grown, perhaps by code that frees";
}

}  // namespace
}  // namespace mauve::rt
