// SPDX-License-Identifier: LGPL-3.0-or-later
/// The values that built-in resources keep when a change at a barrier gives them another type.
#include <gtest/gtest.h>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace mauve {
namespace {

struct Speed1 {
  double metres = 0;
};
struct Speed2 {
  std::int64_t millimetres = 0;
};

}  // namespace

template <>
struct Described<Speed1> {
  static constexpr std::string_view name = "barrier_speed/1";
  static constexpr auto fields() { return std::tuple{field("metres", &Speed1::metres, "m/s")}; }
};
template <>
struct Described<Speed2> {
  static constexpr std::string_view name = "barrier_speed/2";
  static constexpr auto fields() {
    return std::tuple{field("millimetres", &Speed2::millimetres, "mm/s")};
  }
  using Before = Speed1;
  static void convert(const Speed1& old, Speed2& now) noexcept {
    now.millimetres = static_cast<std::int64_t>(old.metres * 1000);
  }
};

namespace {

struct BuiltIn : Architecture {
  SharedData<Speed1> latest{*this, "latest"};
  RingBuffer<Speed1> queue{*this, "queue"};
};

class BarrierOfData : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  Result<Receipt> exchange(std::shared_ptr<ResourceBase> other,
                           StatePolicy state = StatePolicy::keep) {
    Change change;
    change.remove = {other->name()};
    change.new_resources.push_back({std::move(other), {}, state});
    change.sync = Sync::barrier;
    return deployer.apply(change);
  }
  template <typename T>
  DataStatus read(const char* name, T& value, Cursor& cursor) {
    return architecture.find_resource(name)->find_service("read")->read(&value, cursor);
  }

  BuiltIn architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(BarrierOfData, ConvertsTheLatestValueWithItsAge) {
  const Speed1 written{1.5};
  architecture.latest.write_service().write(&written);
  Speed1 old;
  Cursor before;
  before.slot = ~0U;
  static_cast<void>(read("latest", old, before));

  const auto done = exchange(std::make_shared<SharedDataBase>("latest", data_type<Speed2>()));

  ASSERT_TRUE(done) << to_string(done.error());
  Speed2 now;
  Cursor after;
  after.slot = ~0U;
  EXPECT_EQ(read("latest", now, after), DataStatus::new_data);
  EXPECT_EQ(now.millimetres, 1500);
  EXPECT_EQ(after.stamp, before.stamp);
  EXPECT_EQ(done->components[0].bytes, sizeof(Speed1));
}

TEST_F(BarrierOfData, KeepsTheOrderOfAQueue) {
  for (const double metres : {1.0, 2.0, 3.0}) {
    const Speed1 written{metres};
    architecture.queue.write_service().write(&written);
  }

  const auto done = exchange(std::make_shared<RingBufferBase>("queue", data_type<Speed2>()));

  ASSERT_TRUE(done) << to_string(done.error());
  Speed2 now;
  Cursor cursor;
  for (const std::int64_t millimetres : {1000, 2000, 3000}) {
    ASSERT_EQ(read("queue", now, cursor), DataStatus::new_data);
    EXPECT_EQ(now.millimetres, millimetres);
  }
  EXPECT_EQ(read("queue", now, cursor), DataStatus::no_data);
}

TEST_F(BarrierOfData, RefusesATypeThatCannotBeMadeFromTheOneBefore) {
  const auto other = [] { return std::make_shared<SharedDataBase>("latest", data_type<double>()); };
  const Speed1 written{1.5};
  architecture.latest.write_service().write(&written);

  const auto refused = exchange(other());
  const auto dropped = exchange(other(), StatePolicy::drop);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::type_mismatch);
  EXPECT_EQ(refused.error().at, "latest");
  EXPECT_EQ(refused.error().message,
            "latest holds values of barrier_speed/1, and double cannot be made from them");
  ASSERT_TRUE(dropped) << to_string(dropped.error());
  double now = 0;
  Cursor cursor;
  cursor.slot = ~0U;
  EXPECT_EQ(read("latest", now, cursor), DataStatus::no_data);
}

}  // namespace
}  // namespace mauve
