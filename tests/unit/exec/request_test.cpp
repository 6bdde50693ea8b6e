// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests of real-time code, up to the [log] thread that takes them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/plugin.h>
#include <mauve/request.h>

namespace mauve {
namespace {

/// Asks for everything in `names`, in every job.
class Asking : public Core<EmptyShell> {
 public:
  void update() {
    for (const std::string& name : names) heard.push_back(request(name));
  }
  std::vector<std::string> names;
  std::vector<bool> heard;
};

class Requests : public testing::Test {
 protected:
  Requests() { asking_.fsm().period = 10ms; }

  std::vector<RuntimeEvent> drained() {
    std::vector<RuntimeEvent> all;
    deployer_.drain([&](const RuntimeEvent& happening) {
      if (happening.event == "requested") all.push_back(happening);
    });
    return all;
  }

  Architecture architecture_{"sample"};
  Component<EmptyShell, Asking, PeriodicFsm<Asking>> asking_{architecture_, "asking"};
  Deployer deployer_{architecture_, {Realtime::off, true}};
};

TEST_F(Requests, ArriveWithTheirNameAndTheTimeOfTheJob) {
  asking_.core().names = {"drop_gnss", std::string(64, 'x')};
  ASSERT_TRUE(deployer_.deploy());
  deployer_.run_for(5ms);

  const auto all = drained();

  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].component, "asking");
  EXPECT_EQ(all[0].text, "drop_gnss");
  EXPECT_EQ(all[0].time, deployer_.t0());
  EXPECT_EQ(all[1].text, std::string(64, 'x'));
  EXPECT_EQ(asking_.core().heard, (std::vector<bool>{true, true}));
}

TEST_F(Requests, ThatNobodyTookAreNotHeardAnyMore) {
  asking_.core().names = std::vector<std::string>(9, "again");
  ASSERT_TRUE(deployer_.deploy());
  deployer_.run_for(5ms);

  EXPECT_TRUE(asking_.core().heard[7]);
  EXPECT_FALSE(asking_.core().heard[8]) << "the ring holds eight";
  EXPECT_EQ(drained().size(), 8U);
  asking_.core().names = {"again"};
  deployer_.run_for(10ms);
  EXPECT_TRUE(asking_.core().heard.back()) << "there is room again";
}

TEST_F(Requests, WithoutANameOrWithTooLongAOneAreNotHeard) {
  asking_.core().names = {"", std::string(65, 'x')};
  ASSERT_TRUE(deployer_.deploy());
  deployer_.run_for(5ms);

  EXPECT_EQ(asking_.core().heard, (std::vector<bool>{false, false}));
  EXPECT_TRUE(drained().empty());
}

TEST_F(Requests, OutsideAJobAreNotHeard) {
  ASSERT_TRUE(deployer_.deploy());

  EXPECT_FALSE(request("drop_gnss"));
  EXPECT_TRUE(drained().empty());
}

}  // namespace
}  // namespace mauve
