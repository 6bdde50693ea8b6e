// SPDX-License-Identifier: LGPL-3.0-or-later
// The generations that rules and components made, as an undo names them.
#include "supervision/makers.h"

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

rules::Steps set_gain() {
  rules::Step step;
  step.action = rules::Action::set;
  step.subject = "control.core.gain";
  return {step};
}

std::vector<OpenProbation> open_probation() {
  OpenProbation open;
  open.generations = {2, 3};
  open.components = {"control"};
  return {open};
}

TEST(Makers, NameTheGenerationsOfOneRuleTogether) {
  Makers makers;
  for (const auto generation : std::vector<std::uint64_t>{4, 5, 6}) {
    makers.remember(generation, {"by rule loud", 0});
  }

  EXPECT_EQ(makers.notes_on({4, 6}, [](rules::RuleId) { return std::string(); }),
            (std::vector<std::string>{"generations 4, 6 were made by rule loud"}));
}

TEST(Makers, NameARuleOnceThatMadeAChangeAndThenReliedOnIt) {
  Makers makers;
  makers.remember(2, {"by rule loud", 0});

  for (int i = 0; i < 2; ++i) {
    makers.rely(open_probation(), set_gain(), {"relied on by rule loud", 0});
    makers.rely(open_probation(), set_gain(), {"relied on by rule quiet", 1});
  }

  EXPECT_EQ(makers.notes_on({2, 3},
                            [](rules::RuleId rule) {
                              return std::string(
                                  rule == 0 ? "which fires again while its condition holds" : "");
                            }),
            (std::vector<std::string>{
                "generation 2 was made by rule loud, which fires again while its condition holds",
                "generation 3 is relied on by rule quiet"}));
  EXPECT_EQ(makers.forget({2, 3}), (std::vector<rules::RuleId>{0, 1}));
}

}  // namespace
}  // namespace mauve::daemon
