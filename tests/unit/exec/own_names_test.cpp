// SPDX-License-Identifier: LGPL-3.0-or-later
/// A method of an author is the author's own, whatever methods the runtime has.
#include <gtest/gtest.h>

#include "support/ramp.h"

#include <mauve/test_kit.h>

namespace mauve {
namespace {

/// How often somebody called one of the methods below.
int& calls() {
  static int count = 0;
  return count;
}

/// Verbs that are, or were, names of base classes of mauve, and that authors like too.
template <typename Base>
struct WithVerbs : Base {
  void reset() { ++calls(); }
  void verify() { ++calls(); }
  void warm() { ++calls(); }
  void configure() { ++calls(); }
  void cleanup() { ++calls(); }
  void adopt() { ++calls(); }
  void bind() { ++calls(); }
  void use() { ++calls(); }
  bool configured() { return ++calls() > 0; }
  bool stateless() { return ++calls() > 0; }
  int address() { return ++calls(); }
  int initial_bindings() { return ++calls(); }
};

using Panel = WithVerbs<Core<EmptyShell>>;
struct PanelServices : WithVerbs<Interface<Panel>> {
  EventService<> reset{*this, "reset", &Panel::reset};
};
using Ramp = WithVerbs<ramp::Up>;
using NextRamp = WithVerbs<ramp::Down>;

struct OperatorShell : WithVerbs<Shell> {
  EventPort<> reset{*this, "reset"};
};
struct Operator : WithVerbs<Core<OperatorShell>> {
  void update() { shell().reset(); }
};
struct OperatorFsm : WithVerbs<Fsm<Operator>> {
  Exec reset{*this, "reset", &Operator::update};
  Sync verify{*this, "verify", 10ms};
  Status on_configure() override {
    start_at(verify);
    verify.then(reset);
    reset.then(verify);
    return ok();
  }
};

/// The operator presses the button of the panel in each job; the ramp runs beside.
struct Machine : Architecture {
  Resource<EmptyShell, Panel, PanelServices> panel{*this, "panel"};
  Component<OperatorShell, Operator, OperatorFsm> operator_{*this, "operator"};
  Component<ramp::Shell, Ramp, ramp::Fsm> control{*this, "control"};
  Status on_configure() override {
    return operator_.shell().reset.connect(panel.interface().reset);
  }
};

class OwnNames : public testing::Test {
 protected:
  void SetUp() override { calls() = 0; }
};

TEST_F(OwnNames, OfACoreAreNotCalledByAStartAChangeOrAStop) {
  Machine architecture;
  Deployer deployer(architecture, {.simulated = true});

  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.swap_core<NextRamp>("control"));
  ASSERT_TRUE(deployer.stop({"operator"}));
  ASSERT_TRUE(deployer.start({"operator"}));
  EXPECT_TRUE(deployer.shutdown().empty());

  EXPECT_EQ(calls(), 0);
}

TEST_F(OwnNames, AreCalledByTheEventThatTheAuthorGaveThemTo) {
  Machine architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(35ms);

  EXPECT_EQ(calls(), 3);
}

TEST_F(OwnNames, AreNotCalledByTheBenchOfACore) {
  {
    CoreBench<OperatorShell, Operator> bench;
    ASSERT_TRUE(bench.configure());
    EXPECT_TRUE(static_cast<CoreBase&>(bench.core()).configured());
  }

  EXPECT_EQ(calls(), 0);
}

}  // namespace
}  // namespace mauve
