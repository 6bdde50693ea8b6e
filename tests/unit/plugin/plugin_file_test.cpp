// SPDX-License-Identifier: LGPL-3.0-or-later
/// Only files that nobody untrusted can have written become code.
#include "plugin/load/plugin_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/temp_dir.h"

namespace mauve::plugin::test {
namespace {

namespace fs = std::filesystem;
using mauve::test::TempDir;
using ::testing::HasSubstr;

class PluginFileTest : public ::testing::Test {
 protected:
  Result<PluginFile> read(std::string_view name) const {
    return read_plugin_file({folder_.path().string()}, name, trust_);
  }
  void write(std::string_view name, fs::perms mode = fs::perms(0644)) const {
    fs::permissions(folder_.write(name, "bytes"), mode);
  }
  std::string refusal(std::string_view name) const {
    const Result<PluginFile> file = read(name);
    return file ? "accepted" : to_string(file.error());
  }

  TempDir folder_;
  Trust trust_{{0, geteuid()}, {}};
};

TEST_F(PluginFileTest, ReadsTheBytesOfAGoodFile) {
  write("good.so");

  const Result<PluginFile> file = read("good");

  ASSERT_TRUE(file) << to_string(file.error());
  EXPECT_EQ(file->bytes.size(), 5U);
  EXPECT_EQ(file->path, (folder_ / "good.so").string());
}

TEST_F(PluginFileTest, TakesNamesAndNeverPaths) {
  write("good.so");
  for (const char* name : {"", "../good", "/etc/passwd", "good.so", "Good", "good\n", "_good"}) {
    const Result<PluginFile> file = read(name);
    ASSERT_FALSE(file) << name;
    EXPECT_EQ(file.error().code, Errc::invalid_value) << name;
  }
  EXPECT_FALSE(read(std::string(65, 'a')));
}

TEST_F(PluginFileTest, SuggestsTheNearestFile) {
  write("guidance.so");

  const Result<PluginFile> file = read("guidnace");

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().message, "there is no guidnace.so in " + folder_.path().string());
  EXPECT_EQ(file.error().hint, "did you mean \"guidance\"?");
}

TEST_F(PluginFileTest, NamesTheFilesThatTheFirstDirectoryHides) {
  const TempDir second;
  write("good.so");
  fs::permissions(second.write("good.so", "other"), fs::perms(0644));
  const std::string first = folder_.path().string();

  const auto both = read_plugin_file({first, second.path().string(), first + "/"}, "good", trust_);
  const auto alone = read_plugin_file({first, first, "/nowhere"}, "good", trust_);

  ASSERT_TRUE(both) << to_string(both.error());
  EXPECT_EQ(both->path, (folder_ / "good.so").string());
  EXPECT_THAT(both->hides, ::testing::ElementsAre((second / "good.so").string()));
  ASSERT_TRUE(alone);
  EXPECT_THAT(alone->hides, ::testing::IsEmpty());
}

TEST_F(PluginFileTest, SaysThatADirectoryIsNotThere) {
  const Result<PluginFile> file = read_plugin_file({"/nowhere"}, "guidance", trust_);

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().message, "there is no guidance.so in /nowhere (no such directory)");
}

TEST_F(PluginFileTest, NamesTheOptionThatAddsADirectory) {
  const Result<PluginFile> file = read("no_such");

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().hint,
            "mauved looks nowhere else; its option --plugin-dir names more directories");
}

TEST_F(PluginFileTest, SaysThatThePluginIsInTheInstalledDirectoryThatAnOptionDropped) {
  const Result<PluginFile> file = read("types");

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().hint,
            "it is in " + installed_directory() + ": name that with --plugin-dir of mauved too");
}

TEST_F(PluginFileTest, TakesTheFirstDirectoryThatHasIt) {
  const TempDir second;
  write("both.so");
  second.write("both.so", "other");
  second.write("only.so", "other");
  const std::vector<std::string> order{"/nowhere", folder_.path(), second.path()};

  EXPECT_EQ(read_plugin_file(order, "both", trust_)->path, (folder_ / "both.so").string());
  EXPECT_EQ(read_plugin_file(order, "only", trust_)->path, (second / "only.so").string());
}

TEST_F(PluginFileTest, RefusesASymbolicLink) {
  write("target.so");
  fs::create_symlink(folder_ / "target.so", folder_ / "link.so");
  fs::create_symlink("/nowhere", folder_ / "dangling.so");

  EXPECT_THAT(refusal("link"), HasSubstr("is a symbolic link"));
  EXPECT_THAT(refusal("dangling"), HasSubstr("is a symbolic link"));
}

TEST_F(PluginFileTest, FollowsALinkToAWholeDirectory) {
  const TempDir other;
  write("good.so");
  fs::create_directory_symlink(folder_.path(), other / "plugins");

  EXPECT_TRUE(read_plugin_file({(other / "plugins").string()}, "good", trust_));
}

TEST_F(PluginFileTest, RefusesWhatIsNoRegularFileWithoutWaiting) {
  fs::create_directory(folder_ / "folder.so");
  ASSERT_EQ(mkfifo((folder_ / "pipe.so").c_str(), 0600), 0);

  EXPECT_THAT(refusal("folder"), HasSubstr("is not a regular file"));
  EXPECT_THAT(refusal("pipe"), HasSubstr("is not a regular file"));
}

TEST_F(PluginFileTest, RefusesAFileThatOthersMayWrite) {
  write("open.so", fs::perms(0666));
  write("group.so", fs::perms(0664));

  EXPECT_THAT(refusal("open"), HasSubstr("may be written by everybody"));
  EXPECT_THAT(refusal("group"), HasSubstr("chmod g-w " + (folder_ / "group.so").string()));
}

TEST_F(PluginFileTest, TakesAFileOfATrustedGroup) {
  write("group.so", fs::perms(0664));
  struct stat status {};
  ASSERT_EQ(stat((folder_ / "group.so").c_str(), &status), 0);
  trust_.groups.insert(status.st_gid);

  EXPECT_TRUE(read("group"));
}

TEST_F(PluginFileTest, RefusesADirectoryThatOthersMayWriteAnywhereAbove) {
  fs::create_directories(folder_ / "open/plugins");
  folder_.write("open/plugins/good.so", "bytes");
  fs::permissions(folder_ / "open", fs::perms(0777));
  const std::vector<std::string> list{(folder_ / "open/plugins").string()};

  const Result<PluginFile> file = read_plugin_file(list, "good", trust_);

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().at, (folder_ / "open").string());
  EXPECT_EQ(file.error().code, Errc::plugin_refused);
}

TEST_F(PluginFileTest, ToleratesAStickyDirectoryAbove) {
  fs::create_directories(folder_ / "sticky/plugins");
  folder_.write("sticky/plugins/good.so", "bytes");
  fs::permissions(folder_ / "sticky", fs::perms(01777));

  EXPECT_TRUE(read_plugin_file({(folder_ / "sticky/plugins").string()}, "good", trust_));
}

TEST_F(PluginFileTest, RefusesTheFileOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file away, and this is another user";
  write("foreign.so");
  ASSERT_EQ(chown((folder_ / "foreign.so").c_str(), 4711, 0), 0);

  EXPECT_THAT(refusal("foreign"), HasSubstr("belongs to user 4711"));
  trust_.owners.insert(4711);
  EXPECT_TRUE(read("foreign"));
}

TEST_F(PluginFileTest, RefusesAFileThatIsTooLarge) {
  write("large.so");
  fs::resize_file(folder_ / "large.so", kLargestPlugin + 1);

  const Result<PluginFile> file = read("large");

  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, Errc::limit);
}

TEST(TrustTest, TrustsWhoeverCanReplaceTheRuntime) {
  const TempDir folder;
  const fs::path library = folder.write("libmauve.so", "");
  fs::permissions(library, fs::perms(0664));
  struct stat status {};
  ASSERT_EQ(stat(library.c_str(), &status), 0);

  const Trust trust = Trust::of(4711, library);

  EXPECT_TRUE(trust.owners.contains(0));
  EXPECT_TRUE(trust.owners.contains(4711));
  EXPECT_TRUE(trust.owners.contains(status.st_uid));
  EXPECT_TRUE(trust.groups.contains(status.st_gid));
}

/// Where check_path() finds the fault; empty: nowhere.
std::string blamed(const fs::path& path) {
  const Status trusted = Trust{{0, geteuid()}, {}}.check_path(path.string());
  return trusted ? "" : trusted.error().at;
}

TEST(TrustTest, JudgesEveryDirectoryAboveAPath) {
  const TempDir folder;
  const fs::path open = folder / "open";
  fs::create_directories(open / "state" / "generations");
  const fs::path file = folder.write("open/state/file.json", "{}");
  EXPECT_EQ(blamed(file), "");

  fs::permissions(open, fs::perms(0777));

  EXPECT_EQ(blamed(file), open.string());
  EXPECT_EQ(blamed(open / "state" / "generations"), open.string());
  EXPECT_EQ(blamed(open), open.string());
  EXPECT_EQ(blamed(open / "not_there_yet"), open.string());
  EXPECT_EQ(blamed(folder / "not_there_yet" / "either"), "");
}

TEST(TrustTest, TakesAStickyDirectoryButNotAFileThatOthersWriteInIt) {
  const TempDir folder;
  fs::permissions(folder.path(), fs::perms(01777));
  const fs::path file = folder.write("file.json", "{}");
  EXPECT_EQ(blamed(file), "");

  fs::permissions(file, fs::perms(0666));

  EXPECT_EQ(blamed(file), file.string());
}

TEST(TrustTest, FollowsASymbolicLinkAndJudgesWhereItLeads) {
  const TempDir folder;
  fs::create_directories(folder / "open" / "inner");
  fs::create_directory(folder / "good");
  fs::create_symlink("../open/inner", folder / "good" / "relative");
  fs::create_symlink(folder / "open", folder / "absolute");
  fs::create_symlink("loop", folder / "loop");
  EXPECT_EQ(blamed(folder / "good" / "relative" / "file"), "");
  EXPECT_EQ(blamed(folder / "absolute" / ".." / "good"), "");

  fs::permissions(folder / "open", fs::perms(0777));

  EXPECT_EQ(blamed(folder / "good" / "relative" / "file"), (folder / "open").string());
  EXPECT_EQ(blamed(folder / "absolute"), (folder / "open").string());
  EXPECT_EQ(blamed(folder / "loop"), (folder / "loop").string());
}

TEST(TrustTest, TrustsNoDirectoryAndNoLinkOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "SKIPPED: only root can give a file to another user";
  const TempDir folder;
  fs::create_directory(folder / "his");
  fs::create_directory(folder / "good");
  fs::create_symlink(folder / "good", folder / "link");
  ASSERT_EQ(lchown((folder / "his").c_str(), 4711, 4711), 0);
  ASSERT_EQ(lchown((folder / "link").c_str(), 4711, 4711), 0);

  EXPECT_EQ(blamed(folder / "his" / "file"), (folder / "his").string());
  EXPECT_EQ(blamed(folder / "link" / "file"), (folder / "link").string());
}

TEST(TrustTest, TakesPluginsFromTheTreeItRunsFrom) {
  EXPECT_TRUE(read_plugin_file({std::string(MAUVE_ZOO) + "/1"}, "good", Trust::of_this_process()));
}

}  // namespace
}  // namespace mauve::plugin::test
