// SPDX-License-Identifier: LGPL-3.0-or-later
/// The floating-point environment of a thread: rounding, subnormal numbers, traps. A function must
/// restore it. If it does not, the arithmetic of all code that the thread runs later is another.
#pragma once

#include <cfenv>
#include <cstdint>

namespace mauve::rt {

#if defined(__x86_64__)
/// Drops what x87 and MMX instructions left. An exception that waits would fire at the next of
/// these instructions, and registers in use would make each long double not a number.
inline void drop_x87_leftovers() {
  asm volatile("fnclex\n\temms"
               :
               :
               : "st", "st(1)", "st(2)", "st(3)", "st(4)", "st(5)", "st(6)", "st(7)", "mm0", "mm1",
                 "mm2", "mm3", "mm4", "mm5", "mm6", "mm7");
}
#elif defined(__aarch64__)
/// Both registers whole. fesetenv() keeps the bits that glibc does not name: the default NaN and
/// the forms of half precision would stay as a body left them.
inline void set_float_registers(std::uint64_t control, std::uint64_t status) {
  asm volatile("msr fpcr, %0\n\tmsr fpsr, %1" : : "r"(control), "r"(status));
}
#endif

/// Rounding to nearest, subnormal numbers as they are, no traps, no flags: as a process begins. The
/// values are those of the System V ABI for x86-64, section 3.4.1; fesetenv() takes 80 ns there,
/// this some 25 ns. [any]
inline void use_default_float_environment() {
#if defined(__x86_64__)
  constexpr unsigned kSse = 0x1f80;
  constexpr unsigned short kX87 = 0x037f;
  drop_x87_leftovers();
  asm volatile("ldmxcsr %0\n\tfldcw %1" : : "m"(kSse), "m"(kX87));
#elif defined(__aarch64__)
  set_float_registers(0, 0);
#else
  static_cast<void>(std::fesetenv(FE_DFL_ENV));
#endif
}

/// That of the calling thread, at the time of its construction. [any]
class FloatEnvironment {
 public:
#if defined(__x86_64__)
  FloatEnvironment() { asm volatile("stmxcsr %0\n\tfnstcw %1" : "=m"(sse_), "=m"(x87_)); }
  void put_back() const {
    drop_x87_leftovers();
    asm volatile("ldmxcsr %0\n\tfldcw %1" : : "m"(sse_), "m"(x87_));
  }

 private:
  unsigned sse_ = 0;
  unsigned short x87_ = 0;
#elif defined(__aarch64__)
  FloatEnvironment() {
    asm volatile("mrs %0, fpcr\n\tmrs %1, fpsr" : "=r"(control_), "=r"(status_));
  }
  void put_back() const { set_float_registers(control_, status_); }

 private:
  std::uint64_t control_ = 0;
  std::uint64_t status_ = 0;
#else
  FloatEnvironment() { std::fegetenv(&environment_); }
  void put_back() const { std::fesetenv(&environment_); }

 private:
  std::fenv_t environment_{};
#endif
};

}  // namespace mauve::rt
