// SPDX-License-Identifier: LGPL-3.0-or-later
/// The cache lines that a job asks for when it begins.
#include "exec/update/prefetch_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "support/ramp.h"

#include <mauve/detail/exchange.h>
#include <mauve/host/deployer.h>

namespace mauve::exec {
namespace {

bool is_near(const PrefetchSet& set, const void* object) {
  const auto& lines = set.lines();
  const std::uintptr_t line = reinterpret_cast<std::uintptr_t>(object) / 64 * 64;
  return std::count(lines.begin(), lines.end(), line) == 1;
}

TEST(PrefetchSet, HasTheCoreThePortAndAllThatItLeadsTo) {
  ramp::Architecture architecture;
  ASSERT_TRUE(architecture.configure());
  auto& control = architecture.control;
  const PrefetchSet set(*control.bundle());

  EXPECT_TRUE(is_near(set, &control.core()));
  EXPECT_TRUE(is_near(set, &control.shell().out));
  ServiceBase& service = architecture.position.write_service();
  EXPECT_TRUE(is_near(set, &service));
  EXPECT_TRUE(is_near(set, &service.resource().lock()));
  EXPECT_TRUE(is_near(set, service.exchange()));
  for (const std::byte* slot : service.exchange()->latest.first_slots()) {
    EXPECT_TRUE(is_near(set, slot));
  }
  EXPECT_FALSE(is_near(set, architecture.speed.write_service().exchange()))
      << "nothing leads there";
}

TEST(PrefetchSet, EndsSomewhereHoweverManyPortsThereAre) {
  struct ManyPorts : Shell {
    std::vector<std::unique_ptr<WritePort<double>>> ports;
    ManyPorts() {
      for (int i = 0; i < 100; ++i) {
        names.push_back("out" + std::to_string(i));
      }
      for (const std::string& name : names) {
        ports.push_back(std::make_unique<WritePort<double>>(*this, name));
      }
    }
    std::vector<std::string> names;
  };
  struct Many : Core<ManyPorts> {
    Stateless stateless{*this};
    void update() {}
  };
  struct System : Architecture {
    SharedData<double> data{*this, "data"};
    Component<ManyPorts, Many, PeriodicFsm<Many>> one{*this, "one"};
    Status on_configure() override {
      for (const auto& port : one.shell().ports) {
        if (Status done = port->connect(data.write_service()); !done) return done;
      }
      return ok();
    }
  } system;
  ASSERT_TRUE(system.configure());

  EXPECT_EQ(PrefetchSet(*system.one.bundle()).lines().size(), 256u);
}

}  // namespace
}  // namespace mauve::exec
