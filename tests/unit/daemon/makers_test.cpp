// SPDX-License-Identifier: LGPL-3.0-or-later
// The generations that rules and components made, as an undo names them.
#include "monitor/makers.h"

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

constexpr std::uint64_t kAdoption = 1;

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

TEST(Makers, NameARuleOnceThatMadeAChangeAndThenReliedOnIt) {
  Makers makers;
  makers.remember(2, {"by rule loud", 0, kAdoption});

  for (int i = 0; i < 2; ++i) {
    makers.rely(open_probation(), set_gain(), {"relied on by rule loud", 0, kAdoption});
    makers.rely(open_probation(), set_gain(), {"relied on by rule quiet", 1, kAdoption});
  }

  EXPECT_EQ(makers.notes_on({2, 3}, kAdoption),
            (std::vector<std::string>{
                "generation 2 was made by rule loud, which fires again while its condition holds",
                "generation 3 is relied on by rule quiet, which fires again while its condition "
                "holds"}));
  EXPECT_EQ(makers.forget({2, 3}, kAdoption), (std::vector<std::size_t>{0, 1}));
}

}  // namespace
}  // namespace mauve::daemon
