// SPDX-License-Identifier: LGPL-3.0-or-later
// Values that a core writes and its port does not let out, while the core is not on probation.
#include "rules_daemon.h"

namespace mauve::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// `second` reads what `first` writes through a port that lets out numbers only.
std::string checked(const std::string& rules = "") {
  return R"({
    "schema": "mauve/architecture/1", "name": "checked", "plugins": ["trial"],
    "rules": [)" +
         rules + R"(],
    "resources": { "signal": { "type": "shared_data", "data": "double" } },
    "components": {
      "first":  { "type": "trial/checked_unit", "properties": { "fsm.period": "2ms" },
                  "ports": { "output": "signal.write" } },
      "second": { "type": "trial/unit", "properties": { "fsm.period": "5ms" },
                  "ports": { "input": "signal.read" } } } })";
}

class CheckedDaemon : public RulesDaemon {
 public:
  using RulesDaemon::RulesDaemon;

  /// `first` has written so many values that are no number, once it got there.
  void write_bad(int values) {
    const Json all = {{"first.core.bad", values}};
    ASSERT_EQ(ask("param.set", {{"values", all}, {"probation", "off"}})["state"], "applied");
  }
  /// The counts of the records of the log about `first`.
  std::vector<int> reported() {
    std::vector<int> counts;
    const auto tail = ask("log.tail", {{"n", 1000}});
    for (const auto& record : tail["records"]) {
      if (record["event"] != "implausible_value") continue;
      EXPECT_EQ(record["component"], "first") << record;
      EXPECT_EQ(record["fields"]["port"], "output") << record;
      counts.push_back(record["fields"]["count"].get<int>());
    }
    return counts;
  }
};

TEST(ImplausibleValues, OffProbationAreInTheLogAtTheFirstAndTheTenthOfEachCore) {
  CheckedDaemon daemon(checked());

  daemon.write_bad(1);
  ASSERT_TRUE(eventually([&] { return !daemon.reported().empty(); }));
  daemon.write_bad(9);
  ASSERT_TRUE(daemon.becomes("first.implausible", 9));
  daemon.write_bad(10);
  ASSERT_TRUE(eventually([&] { return daemon.reported().size() == 2; }));
  EXPECT_THAT(daemon.reported(), ElementsAre(1, 10));
  EXPECT_TRUE(daemon.says("a value that is not plausible: so far 10 of its values"))
      << daemon.errors();

  daemon.ask("core.swap",
             {{"component", "first"}, {"core", "trial/checked_again"}, {"probation", "off"}});
  ASSERT_TRUE(daemon.becomes("first.implausible", 0));
  daemon.write_bad(11);
  ASSERT_TRUE(eventually([&] { return daemon.reported().size() == 3; }));
  EXPECT_THAT(daemon.reported(), ElementsAre(1, 10, 1)) << "the core before wrote ten";
}

TEST(ImplausibleValues, AreCountedInStatusShowWhyAndMetrics) {
  CheckedDaemon daemon(checked());
  EXPECT_THAT(daemon.ctl({"status"}).out, Not(HasSubstr("plausible")));
  EXPECT_THAT(daemon.ctl({"why", "first"}).out, Not(HasSubstr("plausible")));

  daemon.write_bad(3);
  ASSERT_TRUE(daemon.becomes("first.implausible", 3));

  EXPECT_EQ(daemon.component("first")["implausible"], 3);
  EXPECT_EQ(daemon.component("second")["implausible"], 0);
  EXPECT_THAT(daemon.ctl({"status"}).out,
              HasSubstr("first: 3 values of its present core were not plausible, so no reader gets "
                        "them: mauvectl why first\n"));
  const auto port = daemon.ask("object.get", {{"address", "first.ports.output"}});
  EXPECT_EQ(port["implausible"], 3) << port;
  EXPECT_EQ(port["failures"], 3) << port;
  const auto shown = daemon.ask("object.get", {{"address", "first"}});
  EXPECT_EQ(shown["counters"]["implausible"], 3) << shown;
  EXPECT_EQ(shown["ports"][0]["implausible"], 3) << shown;
  const auto why = daemon.ask("component.why", {{"component", "first"}});
  EXPECT_EQ(why["implausible"], Json::parse(R"([{"port": "output", "count": 3}])")) << why;
  EXPECT_THAT(daemon.ctl({"why", "first"}).out,
              HasSubstr("by output (3 values were not plausible): readers keep the value before"));
  EXPECT_THAT(daemon.ask("metrics.get")["text"].get<std::string>(),
              HasSubstr("mauve_implausible_values_total{component=\"first\"} 3\n"));
}

TEST(ImplausibleValues, FireARuleThatIsArmedAgainWithAnotherCore) {
  CheckedDaemon daemon(checked(R"({ "name": "wild", "when": "first.implausible > 0",
      "do": [{ "swap": "first", "core": "trial/checked_again" }] })"));
  ASSERT_TRUE(eventually([&] { return daemon.rule("wild")["state"] == "armed"; }));
  EXPECT_EQ(daemon.rule("wild")["fired"], 0);

  daemon.write_bad(1);

  ASSERT_TRUE(daemon.fired("wild", 1)) << daemon.rule("wild");
  EXPECT_THAT(daemon.answer("wild"), HasSubstr("applied"));
  EXPECT_EQ(daemon.component("first")["core"], "trial/checked_again");
  EXPECT_EQ(daemon.value("first.implausible"), 0);
  EXPECT_TRUE(eventually([&] { return daemon.rule("wild")["state"] == "armed"; }))
      << daemon.rule("wild");
}

TEST(ImplausibleValues, RollAChangeInPlaceBackAsTheyDoAnyOther) {
  CheckedDaemon daemon(checked());

  const auto set = daemon.ask(
      "param.set",
      {{"values", {{"first.core.bad", 100000}}}, {"in_place", true}, {"probation", "500"}});

  ASSERT_EQ(set["state"], "applied") << set;
  EXPECT_TRUE(daemon.logs(1, "rolled_back", "wrote a value that is not plausible: output"))
      << daemon.errors();
  EXPECT_EQ(daemon.value("first.core.bad"), 0);
  EXPECT_TRUE(daemon.ask("quarantine.list")["cores"].empty()) << "the code is the same";
}

TEST(ImplausibleValues, OfTheCoreBeforeBlameNoChangeInPlace) {
  CheckedDaemon daemon(checked());
  daemon.write_bad(1);
  ASSERT_TRUE(daemon.becomes("first.implausible", 1));

  const auto set = daemon.ask(
      "param.set", {{"values", {{"first.core.bad", 5}}}, {"in_place", true}, {"probation", "100"}});

  ASSERT_EQ(set["state"], "applied") << set;
  EXPECT_TRUE(daemon.logs(1, "probation_passed", "100 jobs without a fault")) << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
