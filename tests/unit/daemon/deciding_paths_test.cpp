// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/deciding_paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

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

/// As /tmp: any user may listen there first, also in place of the guardian.
TEST(DecidingPaths, MayNotPutASocketWhereEverybodyMayListen) {
  const test::TempDir folder;
  std::filesystem::permissions(folder.path(),
                               std::filesystem::perms::all | std::filesystem::perms::sticky_bit);
  const auto within = (folder / "within").string();
  std::filesystem::create_directory(within);

  const auto socket = distrust_of({"socket directory", folder.path().string()});

  ASSERT_TRUE(socket);
  EXPECT_THAT(socket->message, HasSubstr("may be written by everybody"));
  EXPECT_THAT(socket->hint, HasSubstr("--socket FILE"));
  EXPECT_FALSE(distrust_of({"socket directory", within})) << "only its owner may write there";
  EXPECT_FALSE(distrust_of({"state directory", folder.path().string()}))
      << "its files are judged one by one";
}

}  // namespace
}  // namespace mauve::daemon
