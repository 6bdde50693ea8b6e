// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core that changes rounding, subnormal numbers or traps does so for its own job.
#include <bit>
#include <cfenv>
#include <cfloat>
#include <cstdint>

#include <gtest/gtest.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "support/ramp.h"

namespace mauve {
namespace {

constexpr std::uint64_t kNoted = 0x7ff8000000000123;

/// Shows the results of arithmetic that no compiler does before.
struct Arithmetic : ramp::RampCore {
  State<ramp::Position> state{*this};
  Observable<double> third{*this, "third"};
  Observable<bool> subnormals{*this, "subnormals"};
  Observable<bool> traps{*this, "traps"};
  Observable<bool> wide{*this, "wide"};
  Observable<bool> payload{*this, "payload"};

  void update() override {
    volatile double one = 1.0;
    volatile double three = 3.0;
    volatile double smallest = DBL_MIN;
    third = one / three;
    subnormals = smallest / 2.0 > 0.0;
    traps = fegetexcept() != 0;
    volatile long double wide_three = 3.0L;
    wide = 1.0L / wide_three * wide_three == 1.0L;
    volatile double noted = std::bit_cast<double>(kNoted);  // not a number, with a note in it
    payload = std::bit_cast<std::uint64_t>(noted + one) == kNoted;
  }
};

/// Leaves everything changed behind.
struct Careless : Arithmetic {
  void update() override {
    Arithmetic::update();
    std::fesetround(FE_UPWARD);
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | 0x8040U);  // flush to zero, denormals are zero
    volatile long double zero = 0.0L;
    volatile long double endless = 1.0L / zero;  // the trap below waits for the next instruction
    static_cast<void>(endless);
#elif defined(__aarch64__)
    std::uint64_t control = 0;
    asm volatile("mrs %0, fpcr" : "=r"(control));
    control |= 0x3000000U;  // flush to zero, default NaN
    asm volatile("msr fpcr, %0" : : "r"(control));
#endif
    feenableexcept(FE_DIVBYZERO | FE_INVALID);
  }
};

#if defined(__x86_64__)
/// Leaves the registers of long double in use.
struct LeavesRegisters : Arithmetic {
  void update() override {
    Arithmetic::update();
    asm volatile("pxor %mm0, %mm0\n\tpxor %mm7, %mm7");
  }
};
#endif

struct Machine : ramp::One<Careless> {};

/// The core of a resource that leaves everything changed behind for its callers.
struct CarelessStore : Core<EmptyShell> {
  State<ramp::Position> state{*this};
  void note(const double& value) {
    state->value = value;
    std::fesetround(FE_UPWARD);
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | 0x8040U);
    asm volatile("pxor %mm0, %mm0\n\tpxor %mm7, %mm7");
#endif
    feenableexcept(FE_DIVBYZERO | FE_INVALID);
  }
};
struct StoreFace : Interface<CarelessStore> {
  WriteService<double> write{*this, "write", &CarelessStore::note};
};

/// Calls the store, then computes.
struct Caller : Arithmetic {
  void update() override {
    shell().out.write(1.0);
    Arithmetic::update();
  }
};
struct CallerAndStore : Architecture {
  Resource<EmptyShell, CarelessStore, StoreFace> store{*this, "store"};
  Component<ramp::Shell, Caller, ramp::Fsm> control{*this, "control"};
  Status on_configure() override { return control.shell().out.connect(store.interface().write); }
};

class FloatEnvironment : public testing::Test {
 protected:
  ~FloatEnvironment() override { std::fesetenv(FE_DFL_ENV); }
};

template <typename Machine>
void expect_default(const Machine& machine) {
  const auto& core = dynamic_cast<const Arithmetic&>(*machine.control.bundle()->core);
  EXPECT_EQ(core.third, 1.0 / 3.0);
  EXPECT_TRUE(core.subnormals);
  EXPECT_FALSE(core.traps);
  EXPECT_TRUE(core.wide);
  EXPECT_TRUE(core.payload);
}

TEST_F(FloatEnvironment, IsTheDefaultInEachJobOfACoreThatChangesIt) {
  Machine architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(100ms);

  expect_default(architecture);
}

#if defined(__x86_64__)
TEST_F(FloatEnvironment, HasItsRegistersFreeInEachJob) {
  ramp::One<LeavesRegisters> architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(100ms);

  EXPECT_TRUE(dynamic_cast<const Arithmetic&>(*architecture.control.bundle()->core).wide);
}
#endif

TEST_F(FloatEnvironment, OfACallerIsAsItWasAfterAServiceThatChangesIt) {
  CallerAndStore architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(100ms);

  expect_default(architecture);
}

TEST_F(FloatEnvironment, IsTheDefaultForACoreThatComesAfterOneThatChangedIt) {
  Machine architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(50ms);
  ASSERT_TRUE(deployer.apply(Change{{ramp::to_core<Arithmetic>("careful")}}));

  deployer.run_for(50ms);

  expect_default(architecture);
}

}  // namespace
}  // namespace mauve
