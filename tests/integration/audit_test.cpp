// SPDX-License-Identifier: LGPL-3.0-or-later
// The audit log has an entry for every change, whoever asked for it.
#include <algorithm>
#include <set>

#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

class AuditOfEveryChange : public Generations {
 protected:
  [[nodiscard]] static Json plain() { return Json::parse(std::string(kTrial)); }
  [[nodiscard]] std::filesystem::path failure() const { return place_ / "fail"; }
  void fail() const { static_cast<void>(place_.write("fail", "")); }
  /// `first` fails when that file is there.
  [[nodiscard]] Json with_brittle(const Json& task) const {
    Json wanted = plain();
    auto& first = wanted["components"]["first"];
    first["core"] = "trial/brittle";
    first["properties"]["core.until_there"] = failure().string();
    first["task"] = task;
    return wanted;
  }
  /// Each generation after the start has a line that says how it came.
  void expect_a_line_for_each_generation(TrialDaemon& daemon) {
    const auto newest = daemon.ask("status.get")["generation"].get<std::uint64_t>();
    std::set<std::uint64_t> recorded;
    EXPECT_TRUE(eventually([&] {
      recorded.clear();
      for (const auto& line : audit_lines()) {
        if (line.value("outcome", "") == "applied") recorded.insert(line.value("generation", 0U));
      }
      for (std::uint64_t number = 2; number <= newest; ++number) {
        if (!recorded.contains(number)) return false;
      }
      return true;
    })) << "of "
        << newest << " generations the log has " << testing::PrintToString(recorded);
  }
};

TEST_F(AuditOfEveryChange, HasTheChangesOfClients) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 2.0}}}})["generation"], 2);
  ASSERT_EQ(daemon.ask("change.undo")["generation"], 3);
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["generation"], 4);
  ASSERT_EQ(daemon.ask("component.start", {{"components", {"second"}}})["generation"], 5);
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");

  for (const auto* method :
       {"param.set", "change.undo", "component.stop", "component.start", "lock.set"}) {
    EXPECT_EQ(audit_line(method, "applied").value("uid", 1'000'000U), geteuid()) << method;
  }
  expect_a_line_for_each_generation(daemon);
}

TEST_F(AuditOfEveryChange, HasTheChangesOfRules) {
  Json wanted = plain();
  wanted["rules"] = {{{"name", "loud"},
                      {"when", "second.core.input > 5"},
                      {"do", {{{"set", "first.core.gain"}, {"value", 1.0}}}}}};
  TrialDaemon daemon(wanted.dump(), options());
  ASSERT_EQ(daemon.ask("param.set", gain(6.0))["state"], "applied");

  const auto line = audit_line("supervision", "applied");

  EXPECT_EQ(line.value("reason", ""), "by rule loud") << line;
  EXPECT_EQ(line.value("changes", ""), "~ first.core.gain: 6 -> 1") << line;
  EXPECT_EQ(line.value("uid", 1'000'000U), geteuid()) << "mauved did it itself";
  const auto late =
      daemon.ask("param.set", {{"values", gain(6.0)["values"]}, {"if_generation", 1}});
  EXPECT_THAT(late.value("message", ""), HasSubstr("3 is running, made by rule loud"));
  expect_a_line_for_each_generation(daemon);
}

TEST_F(AuditOfEveryChange, HasTheRequestsOfComponentsThatWereRefused) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(
      daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/requesting"}})["state"],
      "applied");

  const auto line = audit_line("supervision", "unknown_name");

  EXPECT_EQ(line.value("reason", ""), "requested by first") << line;
  EXPECT_EQ(line.value("outcome", ""), "refused") << line;
}

TEST_F(AuditOfEveryChange, HasRollbacksThatMauvedDecides) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(
      daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/throwing_job"}})["state"],
      "applied");

  const auto line = audit_line("rolled_back", "applied");

  EXPECT_THAT(line.value("reason", ""), HasSubstr("threw")) << line;
  EXPECT_THAT(line.value("changes", ""), HasSubstr("trial/throwing_job -> trial/steady")) << line;
  expect_a_line_for_each_generation(daemon);
}

TEST_F(AuditOfEveryChange, HasRollbacksOfSwapsInPlace) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"},
                                     {"core", "trial/throwing_job"},
                                     {"in_place", true}})["state"],
            "applied");

  EXPECT_THAT(audit_line("rolled_back", "applied").value("reason", ""), HasSubstr("threw"));
  expect_a_line_for_each_generation(daemon);
}

TEST_F(AuditOfEveryChange, HasRestartsAndTheirEnd) {
  const Json task = {{"on_fault", {{"restart", 2}, {"per", "1h"}, {"back_off", "1ms"}}}};
  TrialDaemon daemon(with_brittle(task).dump(), options());
  ASSERT_EQ(daemon.component("first")["state"], "running");

  fail();

  EXPECT_THAT(audit_line("restarted", "applied").value("reason", ""),
              HasSubstr("first the file is there"));
  EXPECT_THAT(audit_line("stays_failed", "refused").value("reason", ""), HasSubstr("used up"));
  expect_a_line_for_each_generation(daemon);
}

TEST_F(AuditOfEveryChange, HasFallbackCoresThatTakeOver) {
  Json wanted = with_brittle({{"on_fault", "fallback"}});
  wanted["components"]["first"]["fallback_core"] = "trial/other";
  TrialDaemon daemon(wanted.dump(), options());
  ASSERT_EQ(daemon.component("first")["state"], "running");

  fail();

  EXPECT_THAT(audit_line("fell_back", "applied").value("reason", ""),
              HasSubstr("first the file is there"));
  expect_a_line_for_each_generation(daemon);
}

}  // namespace
}  // namespace mauve::test
