// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/deciding_paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

using testing::HasSubstr;

/// A user who starts a mauved of his own may have the socket of the service in his environment.
TEST(DecidingPaths, OfASocketOfAnotherUserLeadToASocketOfOnesOwn) {
  if (geteuid() != 0) GTEST_SKIP() << "only root gives a folder to another user";
  const test::TempDir folder;
  ASSERT_EQ(chown(folder.path().c_str(), 4711, 0), 0);

  const auto socket = distrust_of({"socket directory", folder.path().string()});
  const auto state = distrust_of({"state directory", folder.path().string()});

  ASSERT_TRUE(socket && state);
  EXPECT_THAT(socket->hint, HasSubstr("export MAUVE_SOCKET=$HOME/mauve.sock"));
  EXPECT_THAT(socket->hint, HasSubstr("--socket FILE"));
  EXPECT_THAT(state->hint, HasSubstr("chown root"));
}

}  // namespace
}  // namespace mauve::daemon
