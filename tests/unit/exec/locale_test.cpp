// SPDX-License-Identifier: LGPL-3.0-or-later
/// The locale of the process is of everybody: a core that sets it changes no number of another.
#include <locale.h>

#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Looks at the locale of the thread that runs it.
struct Polyglot : ramp::RampCore {
  Stateless stateless{*this};
  Observable<bool> of_process{*this, "of_process", true};
  void update() override { of_process = uselocale(nullptr) == LC_GLOBAL_LOCALE; }
};

TEST(Locale, OfTheProcessIsNotThatOfTheThreadsThatRunJobs) {
  ramp::One<Polyglot> architecture;
  Deployer deployer{architecture, {}};
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(test::runs_on(deployer, "control"));

  static_cast<void>(deployer.shutdown());

  const auto& core = dynamic_cast<const Polyglot&>(*architecture.control.bundle()->core);
  EXPECT_FALSE(core.of_process);
}

}  // namespace
}  // namespace mauve
