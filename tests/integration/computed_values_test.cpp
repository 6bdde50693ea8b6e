// SPDX-License-Identifier: LGPL-3.0-or-later
// A client asks for a value that a plugin computes, and that code fails: on a thread of mauved.
#include "rt/thread/run_guarded.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// `broken` computes its value, and fails as its property says.
std::string with_broken(const std::string& how) {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["resources"]["broken"] = {{"type", "trial/failing"},
                                         {"properties", {{"core.how", how}}}};
  return architecture.dump();
}

Json value_of_broken(TrialDaemon& daemon) {
  return daemon.ask("param.get", {{"address", "broken.read"}});
}

TEST(ComputedValue, ThatThrowsIsRefusedAndHurtsNobody) {
  TrialDaemon daemon(with_broken("throws"));

  const auto error = value_of_broken(daemon);

  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("threw: no bearing")) << error;
  EXPECT_EQ(error["data"]["where"], "broken.read");
  EXPECT_EQ(daemon.ask("status.get")["poisoned"], Json::array());
}

TEST(ComputedValue, ThatFailsOtherwiseIsRefusedAndItsResourcePoisonedUntilItHasANewCore) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  const std::map<std::string, std::string> all{{"crashes", "crashed: SIGSEGV"},
                                               {"exits", "called exit(3)"},
                                               {"loops", "did not return, so it was ended"}};
  for (const auto& [how, said] : all) {
    TrialDaemon daemon(with_broken(how));

    const auto error = value_of_broken(daemon);

    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr(said)) << error;
    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("broken is poisoned"));
    EXPECT_EQ(daemon.ask("status.get")["poisoned"], Json({"broken"})) << how;
    EXPECT_EQ(value_of_broken(daemon)["status"], "poisoned") << "and its code is not run again";
    EXPECT_EQ(daemon.component("first")["state"], "running");
    const auto mended = daemon.ask("param.set", {{"values", {{"broken.core.how", "answers"}}}});
    EXPECT_EQ(mended["state"], "applied") << mended;
    EXPECT_EQ(value_of_broken(daemon)["value"], 1.0) << how;
  }
}

TEST(ComputedValue, ThatIsWatchedWhileItFailsIsNoValueAndTheDaemonServesOn) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  TrialDaemon daemon(with_broken("answers"));
  auto watching = daemon.client();
  ASSERT_TRUE(watching.ask("watch.subscribe", {{"addresses", {"broken.read"}}}).contains("result"));

  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"broken.core.how", "crashes"}}}})["state"],
            "applied");

  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["poisoned"] == Json({"broken"}); }));
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

}  // namespace
}  // namespace mauve::test
