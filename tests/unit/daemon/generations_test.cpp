// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/generations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "state/durable.h"
#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

using test::TempDir;

Generation numbered(std::uint64_t number, Confirmation mark = Confirmation::confirmed) {
  return {number,   "b007", "2026-01-31T12:00:00.000000Z", 1000, "param.set", "why", "",
          "/robot", mark};
}

class GenerationsTest : public testing::Test {
 protected:
  /// As after a restart.
  void open() {
    auto opened = Generations::open(dir / "generations");
    ASSERT_TRUE(opened);
    kept = std::move(*opened);
  }
  void SetUp() override { open(); }

  [[nodiscard]] std::vector<std::uint64_t> numbers() const {
    std::vector<std::uint64_t> all;
    for (const auto& one : kept->list()) {
      all.push_back(one.number);
    }
    return all;
  }

  TempDir dir;
  std::unique_ptr<Generations> kept;
};

TEST_F(GenerationsTest, AreReadBackAsTheyWereSaved) {
  ASSERT_TRUE(kept->save(numbered(41, Confirmation::unconfirmed), "{ \"name\": \"a\" }\n"));
  ASSERT_TRUE(kept->save(numbered(42), "{}\n"));

  open();

  EXPECT_EQ(numbers(), (std::vector<std::uint64_t>{42, 41}));
  EXPECT_EQ(kept->newest(), 42U);
  EXPECT_EQ(kept->text(41).value(), "{ \"name\": \"a\" }\n");
  const auto one = kept->list().back();
  EXPECT_EQ(one.boot, "b007");
  EXPECT_EQ(one.time, "2026-01-31T12:00:00.000000Z");
  EXPECT_EQ(one.uid, 1000U);
  EXPECT_EQ(one.command, "param.set");
  EXPECT_EQ(one.reason, "why");
  EXPECT_EQ(one.mark, Confirmation::unconfirmed);
  EXPECT_FALSE(one.damaged);
}

TEST_F(GenerationsTest, SurviveAReasonThatIsNoText) {
  auto strange = numbered(1);
  strange.reason = "\xff \n // { \" ";
  ASSERT_TRUE(kept->save(strange, "{}"));

  open();

  EXPECT_FALSE(kept->list().front().damaged);
  EXPECT_EQ(kept->text(1).value(), "{}");
}

TEST_F(GenerationsTest, AreMarkedWithoutLosingAnythingElse) {
  ASSERT_TRUE(kept->save(numbered(1, Confirmation::unconfirmed), "{}"));

  ASSERT_TRUE(kept->mark(1, Confirmation::rolled_back));
  EXPECT_EQ(kept->list().front().mark, Confirmation::rolled_back);
  open();

  EXPECT_EQ(kept->list().front().mark, Confirmation::rolled_back);
  EXPECT_EQ(kept->list().front().reason, "why");
  EXPECT_EQ(kept->text(1).value(), "{}");
  EXPECT_FALSE(kept->mark(2, Confirmation::confirmed));
}

TEST_F(GenerationsTest, KeepTheirAuthorAndConfirmationWhenTheirTextIsSavedAnew) {
  ASSERT_TRUE(kept->save(numbered(1, Confirmation::unconfirmed), "{}"));
  auto load = numbered(1);
  load.command = "plugin.load";

  ASSERT_TRUE(kept->save(load, "{ \"plugins\": [] }"));

  EXPECT_EQ(kept->list().front().command, "param.set");
  EXPECT_EQ(kept->list().front().mark, Confirmation::unconfirmed);
  EXPECT_EQ(kept->text(1).value(), "{ \"plugins\": [] }");
}

TEST_F(GenerationsTest, GetTheirAuthorLaterWhenAnotherCommandSavesThemFirst) {
  auto early = numbered(1, Confirmation::confirmed);
  early.command = early.reason = "";
  early.uid = 0;
  ASSERT_TRUE(kept->save(early, "{}"));

  ASSERT_TRUE(kept->save(numbered(1, Confirmation::unconfirmed), "{}"));

  open();
  EXPECT_EQ(kept->list().front().command, "param.set");
  EXPECT_EQ(kept->list().front().uid, 1000U);
  EXPECT_EQ(kept->list().front().mark, Confirmation::confirmed) << "as it was marked meanwhile";
}

TEST_F(GenerationsTest, RecordTheBuildsThatTheyRanWithAlsoWhenTheseChange) {
  auto ran = numbered(1);
  ran.builds = {{"slip", "fa032653"}, {"arm", "12ab"}};
  ASSERT_TRUE(kept->save(ran, "{}"));
  ran.builds["slip"] = "9651293e";

  ASSERT_TRUE(kept->save(ran, "{}")) << "a reload of a plugin without users makes no generation";
  ASSERT_TRUE(kept->mark(1, Confirmation::rolled_back));
  open();

  EXPECT_EQ(kept->find(1)->builds, (Builds{{"slip", "9651293e"}, {"arm", "12ab"}}));
  EXPECT_FALSE(kept->find(2));
}

TEST_F(GenerationsTest, ThatAnOlderMauvedSavedRecordNoBuild) {
  ASSERT_TRUE(kept->save(numbered(1), "{}"));
  ASSERT_EQ(TempDir::read(dir / "generations" / "000001.json").find("builds"), std::string::npos);

  open();

  EXPECT_TRUE(kept->find(1)->builds.empty());
}

TEST_F(GenerationsTest, GoOnAfterTheNewestThatWasMadeAlthoughAFileHasAnEnormousNumber) {
  ASSERT_TRUE(kept->save(numbered(41), "{}"));
  dir.write("generations/999999999999.json", "{}");
  dir.write("generations/000042.json", "no generation");

  open();

  EXPECT_EQ(kept->newest(), 42U) << "a damaged file keeps its number";
  for (std::uint64_t number = 43; number < 46; ++number) {
    ASSERT_TRUE(kept->save(numbered(number), "{}"));
  }
  open();
  EXPECT_EQ(kept->newest(), 45U);
  EXPECT_TRUE(kept->find(45));
}

TEST_F(GenerationsTest, OfWhichAFileIsDamagedAreListedAsSuchAndNotRead) {
  ASSERT_TRUE(kept->save(numbered(1), "{ \"gain\": 1 }"));
  ASSERT_TRUE(kept->save(numbered(2), "{ \"gain\": 2 }"));
  ASSERT_TRUE(kept->save(numbered(3), "{ \"gain\": 3 }"));
  auto flipped = TempDir::read(kept->file(1));
  flipped.replace(flipped.find("\"gain\": 1"), 9, "\"gain\": 9");
  dir.write("generations/000001.json", flipped);
  std::filesystem::resize_file(kept->file(2), 20);
  auto stolen = TempDir::read(kept->file(3));
  dir.write("generations/000004.json", stolen);  // whole, but of another number
  dir.write("generations/000005.json", "");
  dir.write("generations/000006.json", "// mauve generation {\"checksum\":1}\n{}");
  dir.write("generations/000007.json", "// mauve generation []\n{}");

  open();

  EXPECT_EQ(numbers(), (std::vector<std::uint64_t>{7, 6, 5, 4, 3, 2, 1}));
  for (const auto& one : kept->list()) {
    EXPECT_EQ(one.damaged, one.number != 3) << one.number;
    EXPECT_EQ(kept->text(one.number).has_value(), one.number == 3) << one.number;
  }
}

TEST_F(GenerationsTest, ThatOthersMayHaveWrittenAreNotRead) {
  ASSERT_TRUE(kept->save(numbered(1), "{}"));
  ASSERT_TRUE(kept->save(numbered(2), "{}"));
  ASSERT_TRUE(kept->save(numbered(3), "{}"));
  std::filesystem::permissions(kept->file(2), std::filesystem::perms(0666));
  std::filesystem::rename(kept->file(3), dir / "elsewhere");
  std::filesystem::create_symlink(dir / "elsewhere", kept->file(3));

  open();

  EXPECT_TRUE(kept->text(1));
  ASSERT_FALSE(kept->text(2));
  EXPECT_EQ(kept->text(2).error().code, Errc::not_permitted);
  EXPECT_EQ(kept->text(2).error().hint, "chmod o-w " + kept->file(2).string());
  EXPECT_FALSE(kept->text(3)) << "a symbolic link";
}

TEST_F(GenerationsTest, LeaveNothingOfASaveThatWasCutOff) {
  dir.write("generations/000001.json.new", "// mauve gen");
  dir.write("generations/notes.txt", "not ours");

  open();

  EXPECT_TRUE(kept->list().empty());
  EXPECT_FALSE(std::filesystem::exists(dir / "generations/000001.json.new"));
  EXPECT_TRUE(std::filesystem::exists(dir / "generations/notes.txt"));
}

TEST_F(GenerationsTest, AreKeptInANumberAndTheNewestConfirmedOneBesides) {
  ASSERT_TRUE(kept->save(numbered(1), "{}"));
  ASSERT_TRUE(kept->save(numbered(2), "{}"));
  for (std::uint64_t number = 3; number <= 105; ++number) {
    ASSERT_TRUE(kept->save(numbered(number, Confirmation::unconfirmed), "{}"));
  }

  EXPECT_EQ(kept->list().size(), Generations::kKept);
  EXPECT_EQ(kept->list().back().number, 2U) << "the newest confirmed one";
  EXPECT_EQ(kept->list().front().number, 105U);
  EXPECT_FALSE(std::filesystem::exists(kept->file(1)));
  EXPECT_FALSE(kept->text(1));
  open();
  EXPECT_EQ(kept->list().size(), Generations::kKept);
}

TEST_F(GenerationsTest, AreNotSavedWhenTheyAreTooLongToBeRead) {
  ASSERT_TRUE(kept->save(numbered(1), "{}"));

  EXPECT_FALSE(kept->save(numbered(1), std::string(1 << 20, ' ')));

  EXPECT_EQ(kept->text(1).value(), "{}");
}

TEST_F(GenerationsTest, AreIntactWhenTheirDirectoryIsGone) {
  ASSERT_TRUE(kept->save(numbered(1), "{}"));
  std::filesystem::rename(dir / "generations", dir / "away");

  EXPECT_FALSE(kept->save(numbered(2), "{}"));
  EXPECT_EQ(kept->list().size(), 1U);
  std::filesystem::rename(dir / "away", dir / "generations");

  EXPECT_TRUE(kept->save(numbered(2), "{}"));
  EXPECT_EQ(kept->text(1).value(), "{}");
}

TEST(Durable, BeginsANewLineAfterOneThatWasCutOff) {
  const TempDir dir;
  const auto file = dir / "audit.log";
  ASSERT_TRUE(append_lines(file, "one"));
  dir.write("audit.log", "one\ntw");

  ASSERT_TRUE(append_lines(file, "three"));
  ASSERT_TRUE(append_lines(file, "four"));

  EXPECT_EQ(TempDir::read(file), "one\ntw\nthree\nfour\n");
}

TEST(Durable, HoldsADirectoryForOne) {
  const TempDir dir;
  {
    const auto first = hold_directory(dir.path());
    ASSERT_TRUE(first);
    const auto second = hold_directory(dir.path());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::conflict);
  }
  EXPECT_TRUE(hold_directory(dir.path()));
}

TEST(Durable, SaysWhenADirectoryCannotBeMade) {
  const TempDir dir;
  dir.write("file", "");

  EXPECT_FALSE(make_directory(dir / "file"));
  EXPECT_FALSE(make_directory(dir / "nothere" / "deep"));
  EXPECT_TRUE(make_directory(dir / "new"));
  EXPECT_TRUE(make_directory(dir / "new"));
}

}  // namespace
}  // namespace mauve::daemon
