// SPDX-License-Identifier: LGPL-3.0-or-later
/// A swap is short because its code is fetched beforehand, together, from one page.
#include <gtest/gtest.h>
#include <unistd.h>

#include "rt/process/cache.h"

namespace mauve::rt {
namespace {

TEST(SwapCode, FitsOntoOnePage) {
  EXPECT_GT(swap_code_size(), 1000u) << "the code lies in its section";
  EXPECT_LE(swap_code_size(), static_cast<std::size_t>(sysconf(_SC_PAGESIZE)))
      << "a function with the mark MAUVE_RUNS_AT_A_SWAP has grown, perhaps by code that frees";
}

}  // namespace
}  // namespace mauve::rt
