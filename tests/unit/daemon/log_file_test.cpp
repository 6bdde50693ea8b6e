// SPDX-License-Identifier: LGPL-3.0-or-later
// The file of the log: every record is in it as a whole line, or is counted; it follows its name.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "log/lines.h"
#include "log/sink.h"
#include "protocol/framing.h"
#include "support/temp_dir.h"

namespace mauve::logging {
namespace {

using test::TempDir;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::vector<std::string> lines{""};
  for (const char letter : TempDir::read(file)) {
    if (letter == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += letter;
    }
  }
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

/// This process may write so many bytes to a file, as on a disk that is nearly full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

class LogFile : public testing::Test {
 protected:
  LogFile() { EXPECT_TRUE(file_.open()); }

  TempDir dir_;
  std::filesystem::path path_ = dir_ / "log.jsonl";
  RotatedFile file_{path_.string()};
};

TEST_F(LogFile, FollowsItsNameWhenItIsRenamedOrRemoved) {
  ASSERT_TRUE(file_.append("one"));
  std::filesystem::rename(path_, dir_ / "log.1");
  ASSERT_TRUE(file_.append("two"));
  std::filesystem::remove(path_);
  ASSERT_TRUE(file_.append("three"));

  EXPECT_THAT(lines_of(dir_ / "log.1"), ElementsAre("one"));
  EXPECT_THAT(lines_of(path_), ElementsAre("three"));
}

TEST_F(LogFile, GoesOnInAFileThatTookItsNameOrWasCutShort) {
  ASSERT_TRUE(file_.append("one"));
  std::filesystem::rename(path_, dir_ / "log.1");
  std::ofstream(path_) << "of another program\n";
  ASSERT_TRUE(file_.append("two"));
  EXPECT_THAT(lines_of(path_), ElementsAre("of another program", "two"));

  std::filesystem::resize_file(path_, 0);  // logrotate's copytruncate
  ASSERT_TRUE(file_.append("three"));
  EXPECT_EQ(TempDir::read(path_), "three\n");
}

TEST_F(LogFile, SaysWhyItIsGoneAndComesBack) {
  std::filesystem::create_directory(dir_ / "logs");
  RotatedFile file((dir_ / "logs/log.jsonl").string());
  ASSERT_TRUE(file.open());
  std::filesystem::remove_all(dir_ / "logs");

  const auto failed = file.append("lost");
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("No such file or directory"));

  std::filesystem::create_directory(dir_ / "logs");
  EXPECT_TRUE(file.append("written"));
  EXPECT_THAT(lines_of(dir_ / "logs/log.jsonl"), ElementsAre("written"));
}

TEST_F(LogFile, GoesOnUnderItsNewNameWhereItCannotBeMadeAnew) {
  std::filesystem::create_directory(dir_ / "logs");
  RotatedFile file((dir_ / "logs/log.jsonl").string());
  ASSERT_TRUE(file.open());
  std::filesystem::rename(dir_ / "logs", dir_ / "moved");

  ASSERT_TRUE(file.append("kept"));

  EXPECT_THAT(lines_of(dir_ / "moved/log.jsonl"), ElementsAre("kept"));
}

TEST_F(LogFile, HasNoPartOfALineThatFoundNoRoom) {
  ASSERT_TRUE(file_.append("one"));
  for (rlim_t room = 4; room < 12; ++room) {
    const FullDisk full(room);
    const auto failed = file_.append("a longer line");
    ASSERT_FALSE(failed) << room;
    EXPECT_THAT(failed.error().message, HasSubstr("File too large"));
    EXPECT_EQ(TempDir::read(path_), "one\n") << room;
  }
  ASSERT_TRUE(file_.append("two"));
  EXPECT_THAT(lines_of(path_), ElementsAre("one", "two"));
}

TEST_F(LogFile, LeavesAPartOfAnotherProgramAloneOnItsLine) {
  std::ofstream(path_) << R"({"a":)";
  RotatedFile file(path_.string());
  ASSERT_TRUE(file.open());
  ASSERT_TRUE(file.append("one"));

  EXPECT_THAT(lines_of(path_), ElementsAre(R"({"a":)", "one"));
}

TEST_F(LogFile, NeverWaitsForTheReaderOfAFifo) {
  const auto fifo = dir_ / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  RotatedFile file(fifo.string());
  const auto refused = file.open();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().hint, HasSubstr("reader"));

  const rt::Descriptor reader(open(fifo.c_str(), O_RDONLY | O_NONBLOCK));
  ASSERT_TRUE(file.open());
  ASSERT_TRUE(file.append("one"));
  const std::string much(100'000, 'x');  // more than the FIFO takes
  EXPECT_FALSE(file.append(much));
}

TEST_F(LogFile, FailsOnAFullDiskAtOnce) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "there is no /dev/full here";
  }
  RotatedFile file("/dev/full");
  ASSERT_TRUE(file.open());

  const auto failed = file.append("lost");

  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("No space left on device"));
  EXPECT_EQ(failed.error().hint, "free the disk");
}

TEST(FileSink, AppendsJsonLines) {
  const TempDir dir;
  const auto path = dir / "log.jsonl";
  for (int run = 0; run < 2; ++run) {
    auto sink = file_sink(path);
    ASSERT_TRUE(sink);
    ASSERT_TRUE((*sink)->write(make_record(Event::accept_paused, {})));
  }

  const auto lines = lines_of(path);

  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(protocol::parse_json(lines.front()));
}

TEST(FileSink, SaysWhyItCannotBeOpened) {
  const auto sink = file_sink("/nowhere/at/all");

  ASSERT_FALSE(sink);
  EXPECT_EQ(sink.error().at, "/nowhere/at/all");
  EXPECT_EQ(sink.error().hint, "name a file in an existing directory");
}

}  // namespace
}  // namespace mauve::logging
