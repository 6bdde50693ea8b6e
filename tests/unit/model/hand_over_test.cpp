// SPDX-License-Identifier: LGPL-3.0-or-later
/// The hand-over of what is not a component's state: slow states, and the cores of resources.
#include <gtest/gtest.h>

#include "model/element/hand_over.h"
#include "support/positions.h"

namespace mauve {
namespace {

struct Tile {
  std::vector<double> heights;
};
struct Map {
  std::string file;
  std::vector<double> heights;
};

/// How often a map was loaded from its file, in this process.
int& loads() {
  static int count = 0;
  return count;
}

/// Stands on its map.
struct Surveyor : ramp::RampCore {
  Property<std::string> file{*this, "file", "garden", "of the map"};
  Stateless stateless{*this};
  SlowState<Map> map{*this};

  Status on_configure() override {
    if (map && map->file == file.get()) return ok();
    ++loads();
    return map.set({file, {1, 2, 3}});
  }
  void update() override { shell().out.write(map->heights.back()); }
};
struct OtherSurveyor final : Surveyor {};

/// Of a revision before.
struct OldSurveyor final : ramp::RampCore {
  Stateless stateless{*this};
  SlowState<Tile> tile{*this};
  Status on_configure() override { return tile.set({{4, 5}}); }
  void update() override { shell().out.write(tile->heights.back()); }
};
struct Converted final : Surveyor {
  Converts<Tile, Map> from_tile{map, [](const Tile& old, Map& now) {
                                  now = {"garden", old.heights};
                                }};
};
struct FailingToConvert final : Surveyor {
  Converts<Tile, Map> from_tile{
      map, [](const Tile&, Map&) { throw std::runtime_error("no such projection"); }};
};
struct Blind final : ramp::RampCore {
  State<ramp::Position> state{*this};
  void update() override {}
};

/// With a state of described plain bytes.
struct Placed final : ramp::RampCore {
  State<ramp::PositionV1> state{*this};
  void update() override {}
};

template <typename First>
struct Survey : Architecture {
  SharedData<double> height{*this, "height"};
  Component<ramp::Shell, First, ramp::Fsm> control{*this, "control"};
  Status on_configure() override { return control.shell().out.connect(height.write_service()); }
};

template <typename First>
struct Surveying {
  Surveying() { static_cast<void>(deployer.deploy()); }
  double height() {
    deployer.run_for(10ms);
    return ramp::read(architecture.height);
  }
  Surveyor& surveyor() {
    return static_cast<Surveyor&>(architecture.control.ComponentBase::core());
  }
  Survey<First> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST(State, OfDescribedPlainBytesNeedsNoCodeOfItsPlugin) {
  const std::shared_ptr<CoreBase> core = CoreType::of<Placed>("placed").make();
  StateBase& state = *core->declared_state();
  static_cast<Placed&>(*core).state->metres = 3;
  const void* const made_by_plugin = state.data();
  const auto library = std::make_shared<int>(0);

  state.keep_alive(library);

  EXPECT_NE(state.data(), made_by_plugin) << "the plugin would have to free it";
  EXPECT_EQ(static_cast<Placed&>(*core).state->metres, 3);
  EXPECT_EQ(library.use_count(), 1) << "nobody holds the plugin";
}

TEST(SlowState, IsSharedWithTheNextCoreBeforeThatIsConfigured) {
  Surveying<Surveyor> survey;
  const int before = loads();
  const Map* const map = &*survey.surveyor().map;

  const Result<Receipt> done = survey.deployer.swap_core<OtherSurveyor>("control");

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(&*survey.surveyor().map, map) << "not copied";
  EXPECT_EQ(loads(), before) << "nor loaded again";
  EXPECT_EQ(survey.height(), 3.0);
}

TEST(SlowState, IsMadeAnewByACoreThatWantsAnother) {
  Surveying<Surveyor> survey;
  const int before = loads();

  ASSERT_TRUE(survey.deployer.set("control.core.file", "street"));

  EXPECT_EQ(survey.surveyor().map->file, "street");
  EXPECT_EQ(loads(), before + 1);
}

TEST(SlowState, IsConvertedBesideTheSystem) {
  Surveying<OldSurveyor> survey;
  const int before = loads();
  EXPECT_EQ(survey.height(), 5.0);

  const Result<Receipt> done = survey.deployer.swap_core<Converted>("control");

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(survey.surveyor().map->heights, (std::vector<double>{4, 5}));
  EXPECT_EQ(loads(), before);
}

TEST(SlowState, RefusesTheChangeWhenItsConverterThrows) {
  Surveying<OldSurveyor> survey;

  const Result<Receipt> refused = survey.deployer.swap_core<FailingToConvert>("control");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::hook_threw);
  EXPECT_EQ(refused.error().message, "converter threw: no such projection");
  EXPECT_EQ(survey.height(), 5.0);
}

TEST(SlowState, IsNotLostSilently) {
  Surveying<OldSurveyor> survey;
  const CoreType next = CoreType::of<Surveyor>("surveyor");

  const Result<Receipt> other = survey.deployer.swap_core("control", next);
  const Result<Receipt> none = survey.deployer.swap_core<Blind>("control");
  const Result<Receipt> dropped = survey.deployer.swap_core("control", next, StatePolicy::drop);

  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, Errc::type_mismatch);
  EXPECT_NE(other.error().message.find(data_type<Tile>().name), std::string::npos);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().hint.find("mauve::SlowState"), std::string::npos);
  EXPECT_TRUE(dropped);
  EXPECT_EQ(survey.height(), 3.0);
}

TEST(SlowState, CannotBeSetInAJob) {
  struct Careless final : Surveyor {
    Observable<bool> refused{*this, "refused", false, "was refused"};
    void update() override { refused = !map.set({}); }
  };
  Surveying<Careless> survey;
  survey.deployer.run_for(10ms);

  EXPECT_EQ(survey.surveyor().find_observable("refused")->value(), Value(true));
  EXPECT_EQ(survey.surveyor().map->file, "garden");
}

struct Amplifier : Core<Shell> {
  State<ramp::PositionV1> state{*this};
  double read() { return state->metres; }
};
struct AmplifierInterface : Interface<Amplifier> {
  ReadService<double> read{*this, "read", &Amplifier::read};
};
struct ForgetfulAmplifier final : Amplifier {
  State<ramp::PositionV2> instead{*this};
};
struct NewAmplifier final : Amplifier {
  State<ramp::PositionV3> newer{*this};
  Converts<ramp::PositionV1, ramp::PositionV3> from{
      newer, ramp::convert<ramp::PositionV1, ramp::PositionV3>};
};
struct Amplifiers : Architecture {
  Resource<Shell, Amplifier, AmplifierInterface> amplifier{*this, "amplifier"};
};

TEST(ResourceHandOver, FollowsTheSamePlan) {
  Amplifiers architecture;
  ASSERT_TRUE(architecture.configure());
  ResourceBase& resource = architecture.amplifier;
  architecture.amplifier.core().state->metres = 7;
  const auto next = std::make_shared<NewAmplifier>();

  const Result<mauve::HandOver> plan = plan_hand_over(resource.core(), *next, StatePolicy::keep);
  ASSERT_TRUE(plan) << to_string(plan.error());
  EXPECT_FALSE(plan->run().happened());

  EXPECT_EQ(plan->bytes, sizeof(ramp::PositionV1));
  EXPECT_EQ(next->newer->metres, 7.0);
  EXPECT_FALSE(plan_hand_over(*next, ForgetfulAmplifier(), StatePolicy::keep));
  EXPECT_EQ(plan_hand_over(*next, ForgetfulAmplifier(), StatePolicy::drop)->bytes, 0u);
}

TEST(ResourceHandOver, LeavesTheOldObjectAsItWasWhenItConverts) {
  Amplifier old;
  old.state->metres = 7;
  NewAmplifier next;

  EXPECT_FALSE(plan_hand_over(old, next, StatePolicy::keep)->run().happened());
  next.newer->metres = 9;

  EXPECT_EQ(old.state->metres, 7.0);
}

}  // namespace
}  // namespace mauve
