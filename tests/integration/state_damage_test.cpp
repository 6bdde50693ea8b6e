// SPDX-License-Identifier: LGPL-3.0-or-later
// A state directory in which something is damaged, or lies in the way.
#include <sys/stat.h>

#include <fstream>

#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST_F(Generations, ThatAreDamagedAreSkippedForTheNextOlderOne) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const auto older = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", gain(4.0))["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(5.0))["saved"], true);
  crash(daemon);
  auto text = TempDir::read(file("3"));
  text.replace(text.find("4.0"), 3, "7.0");  // good JSON, wrong value
  std::ofstream(file("3")) << text;
  std::filesystem::resize_file(file("4"), 300);

  daemon.start();

  EXPECT_EQ(exported(daemon), older);
  EXPECT_TRUE(daemon.says("generation 4 cannot be started")) << daemon.errors();
  EXPECT_TRUE(daemon.says("generation 3 cannot be started")) << daemon.errors();
  EXPECT_EQ(newest(daemon)["generation"], 5);
}

TEST_F(Generations, OfAnotherNameAreNone) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const Json late = {{"values", {{"first.core.gain", 4.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", late)["generation"], 3);
  crash(daemon);
  std::ofstream(file("3").parent_path() / "3.json") << "{}";  // the file of 3 itself is whole
  std::ofstream(file("3").parent_path() / "18446744073709551615.json") << "{}";

  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << "generation 3 was never confirmed";
  EXPECT_EQ(newest(daemon)["generation"], 4);
}

TEST_F(Generations, StartAlsoWhereRecordingsAreDamaged) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  crash(daemon);
  ASSERT_EQ(mkfifo((state() / "flight-0001-fault.mtrace").c_str(), 0640), 0);
  std::ofstream(state() / "flight-0002-fault.mtrace") << R"({"why":3,"t":{}})"
                                                      << "\n{\"records\":\"x\"}\n";
  std::ofstream(state() / "flight-0003-fault.mtrace") << "{}\n";
  std::filesystem::resize_file(state() / "flight-0003-fault.mtrace", std::uintmax_t{1} << 32);

  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << daemon.errors();
  const auto items = daemon.ask("trace.list")["items"];
  EXPECT_THAT(items.dump(), testing::Not(HasSubstr("flight-0001"))) << "a FIFO is no recording";
  EXPECT_THAT(items.dump(), HasSubstr("flight-0002"));
  const auto page = daemon.ask("trace.read", {{"recording", "flight-0003-fault"}});
  EXPECT_EQ(page["records"], Json::array()) << page;
}

TEST_F(Generations, StartAlsoWhereFilesOfAnEarlierDamageLie) {
  TrialDaemon daemon(kTrial, options());
  static_cast<void>(daemon.client());
  crash(daemon);
  std::filesystem::rename(state() / "generations", state() / "generations.damaged");
  std::ofstream(state() / "generations") << "no folder";

  daemon.start();

  EXPECT_EQ(newest(daemon)["command"], "start") << daemon.errors();
  EXPECT_TRUE(std::filesystem::is_regular_file(state() / "generations.damaged.2"));
}

TEST_F(Generations, AreAnsweredAsNotSavedWhenTheQuarantineIsNot) {
  TrialDaemon daemon(kTrial, options());
  static_cast<void>(daemon.client());
  crash(daemon);
  std::filesystem::create_directories(state() / "quarantine.json" / "inner");
  daemon.start();
  EXPECT_TRUE(was_logged(daemon, "quarantine_lost"));
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));

  const Json release = {{"core", "trial/throwing_job"}};
  EXPECT_EQ(daemon.ask("quarantine.release", release)["saved"], false);
  EXPECT_EQ(daemon.ask("status.get")["saved"], false);
  std::filesystem::remove_all(state() / "quarantine.json");

  EXPECT_EQ(daemon.ask("param.set", gain(2.0))["saved"], true) << "the next change saves it all";
  EXPECT_EQ(TempDir::read(state() / "quarantine.json"), "{\"cores\":[]}\n");
}

}  // namespace
}  // namespace mauve::test
