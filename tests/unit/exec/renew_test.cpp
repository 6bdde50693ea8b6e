// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resources that are made anew under their names, while others use them.
#include <gtest/gtest.h>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "exec/system/prepared.h"

namespace mauve {
namespace {

struct Sum {
  std::int64_t value = 0;
};

}  // namespace

template <>
struct Described<Sum> {
  static constexpr std::string_view name = "renew_sum/1";
  static constexpr auto fields() { return std::tuple{field("value", &Sum::value)}; }
};

namespace {

/// Adds what it is given, in steps of a shell that cannot change while it runs.
struct AdderShell : Shell {
  Property<std::int64_t> step{*this, "step", 1, "each time"};
};
struct AdderCore : Core<AdderShell> {
  State<Sum> sum{*this};
  Property<std::int64_t> factor{*this, "factor", 1, "of the step"};
  Observable<std::int64_t> calls{*this, "calls", 0, "so far"};
  void add(const double& /*value*/) {
    sum->value += shell().step * factor;
    ++calls;
  }
};
struct AdderInterface : Interface<AdderCore> {
  WriteService<double> add{*this, "add", &AdderCore::add};
};

struct OutShell : Shell {
  WritePort<double> out{*this, "out"};
};
struct RelayCore : Core<OutShell> {
  Stateless stateless{*this};
  void pass(const double& value) { shell().out.write(value); }
};
struct RelayInterface : Interface<RelayCore> {
  WriteService<double> pass{*this, "pass", &RelayCore::pass};
};

/// Says nothing about its state.
struct VagueCore : Core<AdderShell> {
  void add(const double& /*value*/) {}
};
struct VagueInterface : Interface<VagueCore> {
  WriteService<double> add{*this, "add", &VagueCore::add};
};

struct Writer : Core<OutShell> {
  Stateless stateless{*this};
  void update() { shell().out.write(1.0); }
};

/// `near` adds at the adder, `far` through the relay.
struct Adding : Architecture {
  Resource<AdderShell, AdderCore, AdderInterface> adder{*this, "adder"};
  Resource<OutShell, RelayCore, RelayInterface> relay{*this, "relay"};
  Resource<AdderShell, VagueCore, VagueInterface> vague{*this, "vague"};
  SharedData<double> shared{*this, "shared"};
  mauve::Component<OutShell, Writer, PeriodicFsm<Writer>> near{*this, "near"};
  mauve::Component<OutShell, Writer, PeriodicFsm<Writer>> far{*this, "far"};

  Status on_configure() override {
    near.fsm().period = 10ms;
    far.fsm().period = 20ms;
    for (Status done : {near.shell().out.connect(adder.interface().add),
                        far.shell().out.connect(relay.interface().pass)}) {
      if (!done) return done;
    }
    return relay.shell().out.connect(adder.interface().add);
  }
};

class Renew : public testing::Test {
 protected:
  void SetUp() override {
    architecture.adder.core().factor = 10;
    architecture.adder.lock().set_budget(1ms);
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(100ms);
  }
  [[nodiscard]] ResourceBase& adder() const { return *architecture.find_resource("adder"); }
  [[nodiscard]] const AdderCore& core() const {
    return static_cast<const AdderCore&>(adder().core());
  }
  [[nodiscard]] const AdderShell& shell() const {
    return static_cast<const AdderShell&>(adder().shell());
  }

  /// The change on probation is rolled back, and the elements that it brought are freed.
  void roll_back() {
    ASSERT_TRUE(deployer.undo());
    deployer.run_for(50ms);
    ASSERT_EQ(deployer.tend(retired).size(), 1u);
    static_cast<void>(retired.release());
  }

  Adding architecture;
  Deployer deployer{architecture, {.simulated = true}};
  Retired retired;
};

TEST_F(Renew, AShellPropertyChangesAndStateValuesAndUsersGoOn) {
  const std::int64_t calls = core().calls;
  ASSERT_GT(calls, 5);

  const Result<Receipt> done = deployer.set("adder.shell.step", 3);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_NE(&adder(), &architecture.adder);
  EXPECT_EQ(shell().step, 3);
  EXPECT_EQ(core().factor, 10);
  EXPECT_EQ(adder().lock().budget(), 1ms);
  const std::int64_t before = core().calls;
  EXPECT_EQ(core().sum->value, 10 * calls + 30 * (before - calls)) << "nothing was lost";
  deployer.run_for(100ms);
  const auto added = static_cast<double>(core().calls - before);
  EXPECT_NEAR(added, 15, 1) << "ten of the near one, five through the relay";
  EXPECT_EQ(core().sum->value - 10 * calls, 30 * (core().calls - calls));
}

TEST_F(Renew, TheTypeOfANewerBuildTakesOver) {
  struct Newer : AdderCore {};
  Edit edit;
  edit.member = "adder";
  edit.resource = architecture.adder.type();
  edit.resource->core.make = detail::make<CoreBase, Newer>;
  const std::int64_t calls = core().calls;

  const Result<Receipt> done = deployer.apply({{edit}});
  deployer.run_for(20ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_NE(dynamic_cast<const Newer*>(&adder().core()), nullptr);
  EXPECT_EQ(core().sum->value, 10 * core().calls);
  EXPECT_GT(core().calls, calls);
}

TEST_F(Renew, RefusesALockBudgetThatCannotBe) {
  Edit edit;
  edit.member = "adder";
  edit.properties.emplace_back("shell.step", 3);
  edit.lock_budget = -1us;

  const Result<Receipt> done = deployer.apply({{edit}});

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().at, "adder.lock_budget");
  EXPECT_EQ(&adder(), &architecture.adder);
}

TEST_F(Renew, RefusesWhatOnlyAComponentHas) {
  std::vector<Edit> edits(5);
  edits[0].mode = Mode::park;
  edits[1].core = architecture.adder.type().core;
  edits[2].fsm = architecture.near.type().fsm;
  edits[3].type = architecture.near.type();
  edits[4].task.emplace();
  for (Edit& edit : edits) {
    edit.member = "adder";
    edit.properties.emplace_back("shell.step", 3);

    const Result<Receipt> done = deployer.apply({{edit}});

    ASSERT_FALSE(done) << "edit " << &edit - edits.data();
    EXPECT_EQ(done.error().code, Errc::unsupported);
    EXPECT_EQ(&adder(), &architecture.adder);
  }
}

TEST_F(Renew, TheOldOneComesBackWhenTheChangeIsRolledBack) {
  Edit edit;
  edit.member = "adder";
  edit.properties.emplace_back("shell.step", 3);
  Change change{{edit}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));
  ASSERT_NE(&adder(), &architecture.adder);

  ASSERT_TRUE(deployer.undo());
  deployer.run_for(50ms);
  Retired ended;
  static_cast<void>(deployer.tend(ended));
  const std::int64_t calls = core().calls;
  deployer.run_for(100ms);

  EXPECT_EQ(&adder(), &architecture.adder);
  EXPECT_EQ(shell().step, 1);
  EXPECT_EQ(core().calls - calls, 15);
}

/// A change that was prepared while a port was apart does not know the user that a rollback gives
/// the resource again.
TEST_F(Renew, IsRefusedWhenARollbackConnectsAnotherUserBeforeTheCommit) {
  Edit apart;
  apart.member = "near";
  apart.disconnect = {"out"};
  Change change{{apart}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));
  Edit edit;
  edit.member = "adder";
  edit.properties.emplace_back("shell.step", 3);
  auto anew = deployer.prepare({{edit}});
  ASSERT_TRUE(anew) << to_string(anew.error());
  roll_back();

  const Result<Receipt> done = deployer.commit(*anew, retired);

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::conflict);
  EXPECT_EQ(done.error().at, "near.ports.out");
  EXPECT_EQ(&adder(), &architecture.adder);
  const std::int64_t calls = core().calls;
  deployer.run_for(100ms);
  EXPECT_EQ(core().calls - calls, 15) << "all go on as before";
  EXPECT_TRUE(deployer.set("adder.shell.step", 3));
}

TEST_F(Renew, IsRefusedWhenARollbackConnectsTheResourceItselfElsewhere) {
  Edit elsewhere;
  elsewhere.member = "relay";
  elsewhere.disconnect = {"out"};
  elsewhere.connect = {{"out", "vague.add"}};
  Change change{{elsewhere}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));
  Edit edit;
  edit.member = "relay";
  edit.resource = architecture.relay.type();
  edit.state = StatePolicy::drop;
  auto anew = deployer.prepare({{edit}});
  ASSERT_TRUE(anew) << to_string(anew.error());
  roll_back();

  const Result<Receipt> done = deployer.commit(*anew, retired);

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::conflict);
  EXPECT_EQ(done.error().at, "relay");
}

/// Prepares a change while `extra` is on probation, and commits it after `extra` has left again.
class Overtaken : public Renew {
 protected:
  void SetUp() override {
    Renew::SetUp();
    Change joins;
    joins.new_resources.push_back(
        {std::make_shared<ResourceBase>("extra", architecture.adder.type()), {}});
    joins.probation.emplace();
    ASSERT_TRUE(deployer.apply(joins));
  }
  /// Nothing of the resource that left is in the architecture, or used.
  void expect_conflict(const Change& change, const std::string& at) {
    auto prepared = deployer.prepare(change);
    ASSERT_TRUE(prepared) << to_string(prepared.error());
    roll_back();

    const Result<Receipt> done = deployer.commit(*prepared, retired);

    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::conflict);
    EXPECT_EQ(done.error().at, at);
    EXPECT_EQ(architecture.find_resource("extra"), nullptr);
    const std::int64_t calls = core().calls;
    deployer.run_for(100ms);
    EXPECT_EQ(core().calls - calls, 15) << "all go on as before";
  }
  static Edit set_extra(const char* property) {
    Edit edit;
    edit.member = "extra";
    edit.properties.emplace_back(property, 2);
    return edit;
  }
};

TEST_F(Overtaken, AConnectionIsRefusedWhoseServiceARollbackTookAway) {
  Edit edit;
  edit.member = "near";
  edit.disconnect = {"out"};
  edit.connect = {{"out", "extra.add"}};

  expect_conflict({{edit}}, "near.ports.out");
}

/// Its maker describes the change, for example to a user, before anything refuses it.
TEST_F(Overtaken, AServiceThatARollbackTookAwayStaysAliveWithThePreparedChangeThatConnectsIt) {
  Edit edit;
  edit.member = "near";
  edit.disconnect = {"out"};
  edit.connect = {{"out", "extra.add"}};
  std::optional<Result<PreparedChange>> prepared = deployer.prepare({{edit}});
  ASSERT_TRUE(*prepared) << to_string(prepared->error());
  const std::weak_ptr<void> extra = architecture.owner_of(*architecture.find_resource("extra"));

  roll_back();

  EXPECT_FALSE(extra.expired());
  const Bundle& next = *(**prepared).content().members.front().next;
  EXPECT_EQ(next.bindings->front()->service().address(), "extra.add");
  prepared.reset();
  EXPECT_TRUE(extra.expired());
}

TEST_F(Overtaken, AResourceIsNotChangedThatARollbackTookAway) {
  expect_conflict({{set_extra("core.factor")}}, "extra");
}

TEST_F(Overtaken, AResourceIsNotMadeAnewThatARollbackTookAway) {
  expect_conflict({{set_extra("shell.step")}}, "extra");
}

TEST_F(Overtaken, AResourceIsNotRemovedThatARollbackTookAway) {
  Change leaves;
  leaves.remove = {"extra"};

  expect_conflict(leaves, "extra");
}

TEST_F(Overtaken, ASoundChangeIsCommittedAllTheSame) {
  Edit edit;
  edit.member = "far";
  edit.disconnect = {"out"};
  auto prepared = deployer.prepare({{edit}});
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  roll_back();

  EXPECT_TRUE(deployer.commit(*prepared, retired));
}

/// The component `far` reaches the adder through the relay only. A rollback that connects `far`
/// during the barrier would let it call the adder while the adder hands its state over.
TEST_F(Renew, EndsTheProbationOfAChangeWhoseRollbackWouldReachTheResourceThroughAnother) {
  Edit apart;
  apart.member = "far";
  apart.disconnect = {"out"};
  Change change{{apart}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));

  const Result<Receipt> done = deployer.set("adder.shell.step", 3);

  ASSERT_TRUE(done) << to_string(done.error());
  ASSERT_EQ(done->notes.size(), 1u);
  EXPECT_NE(done->notes[0].find("ends early"), std::string::npos) << done->notes[0];
  Retired ended;
  static_cast<void>(deployer.tend(ended));
  EXPECT_FALSE(deployer.undo()) << "nothing rolls back";
}

TEST_F(Renew, IsRefusedWhereAStateWouldVanishOrNoPropertyIs) {
  const Result<Receipt> vanishing = deployer.set("vague.shell.step", 3);
  const Result<Receipt> unknown = deployer.set("adder.shell.stepp", 3);
  const Result<Receipt> built_in = deployer.set("shared.shell.step", 3);

  ASSERT_FALSE(vanishing);
  EXPECT_EQ(vanishing.error().code, Errc::unsupported);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().hint, "did you mean adder.shell.step?");
  ASSERT_FALSE(built_in);
  EXPECT_EQ(built_in.error().code, Errc::unknown_name);
  EXPECT_EQ(&adder(), &architecture.adder);
  EXPECT_TRUE(deployer.set("vague.shell.step", 3, StatePolicy::drop));
}

}  // namespace
}  // namespace mauve
