// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "trial" of the integration tests: one component and cores that behave well or badly.
/// Built with NUMBER 1 and 2, so that a rebuilt file can be distinguished from the one before, and
/// with 3, whose state is of a later revision.
#include <mauve/request.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>

#include "trial_resources.h"

namespace trial {
namespace {

struct TrialShell : mauve::Shell {
  mauve::ReadPort<double> input{*this, "input", 0.5, mauve::Need::optional};
  mauve::WritePort<double> output{*this, "output", mauve::Safe{-1.0}};
  mauve::Property<std::int64_t> size{*this, "size", 7, "of the shell"};
};

class TrialCore : public mauve::Core<TrialShell> {
 public:
  using Contract = TrialCore;
  static constexpr const char* contract = "trial/core/1";

  virtual void update() = 0;  // [rt] every period
};

/// Counts, writes its gain, shows which build it is of.
class Steady : public TrialCore {
 public:
  void update() override {
    count = ++state->count;
    number = NUMBER;  // a swap to the same core hands observables over
    input = shell().input.read();
    shell().output.write(gain);
  }

 protected:
  mauve::State<Memory> state{*this};
#if NUMBER == 3
  mauve::Converts<MemoryV1, Memory> from_v1{
      state, [](const MemoryV1& old, Memory& now) noexcept { now.count = old.count; }};
#endif
  mauve::Property<double> gain{*this, "gain", 1.0, "written out", {.min = 0.0, .max = 10.0}};
  mauve::Observable<std::int64_t> count{*this, "count", 0, "jobs so far"};
  mauve::Observable<double> input{*this, "input", 0, "what was read"};
  mauve::Observable<std::int64_t> number{*this, "number", 0, "of the build"};
};

class Other final : public Steady {};

/// Only build 1 has it.
class Former final : public Steady {};

/// Writes the sign of its input to a file, as a driver writes to its device.
class Noting final : public Steady {
  mauve::Property<std::string> file{*this, "file", "", "its path"};
  mauve::Property<bool> alone{*this, "alone", false, "only one core at a time can hold the file"};
  int open_ = -1;

  mauve::Status on_configure() override {
    open_ = ::open(file.get().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (open_ < 0) return mauve::invalid(file, "cannot be opened");
    if (!alone || ::flock(open_, LOCK_EX | LOCK_NB) == 0) return mauve::ok();
    ::close(std::exchange(open_, -1));
    return mauve::invalid(file, "is held by another core");
  }
  void on_cleanup() override { ::close(open_); }
  void update() override {
    Steady::update();
    const char sign = shell().input.read() < 0 ? '-' : '+';
    if (::pwrite(open_, &sign, 1, 0) < 0) throw std::runtime_error("cannot be written");
  }
};

/// Writes its count: every value differs from the one before.
class Counting final : public Steady {
  void update() override {
    Steady::update();
    shell().output.write(static_cast<double>(state->count));
  }
};

/// Writes its gain while that is over 1, else no number.
class Undefined final : public Steady {
  void update() override {
    Steady::update();
    if (gain <= 1.0) shell().output.write(std::numeric_limits<double>::quiet_NaN());
  }
};

/// Logs in every job, with a text that lies in its own code.
class Talking final : public Steady {
  void update() override {
    Steady::update();
    mauve::log(mauve::LogLevel::info, NUMBER == 1 ? "one says {}" : "two says {}", state->count);
  }
};

/// Takes its time to get ready, and makes a file when it begins to.
class Slow final : public Steady {
  mauve::Property<mauve::Duration> configure_time{*this, "configure_time",
                                                  std::chrono::milliseconds(1500)};
  mauve::Property<std::string> marker{*this, "marker", "", "path of the file; empty: none"};
  mauve::Status on_configure() override {
    if (!marker.get().empty()) std::ofstream(marker.get()) << "begun";
    std::this_thread::sleep_for(configure_time.get());
    return mauve::ok();
  }
};

/// Never gets ready while the file is there; then makes another one when it is cleaned up.
class Stuck final : public Steady {
  mauve::Property<std::string> while_there{*this, "while_there", "", "path of the file"};
  mauve::Property<std::string> cleaned{*this, "cleaned", "", "path of the other file"};
  mauve::Status on_configure() override {
    while (std::filesystem::exists(while_there.get())) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return mauve::ok();
  }
  void on_cleanup() override { std::ofstream(cleaned.get()) << "cleaned"; }
};

/// Never comes into being, or never ends, while that file is there.
class StuckConstructor final : public Steady {
 public:
  StuckConstructor() { wait_for_file_to_go(); }
};
class StuckDestructor final : public Steady {
 public:
  ~StuckDestructor() override { wait_for_file_to_go(); }
};

/// Constructors that do harm.
class CrashingConstructor final : public Steady {
 public:
  CrashingConstructor() { raise(SIGSEGV); }
};
class ExitingConstructor final : public Steady {
 public:
  ExitingConstructor() { std::exit(3); }
};
class HoardingConstructor final : public Steady {
  /// A sixteenth of the machine's memory, reserved and not used.
  static std::size_t share() {
    return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) / 16;
  }
  const std::unique_ptr<char[]> memory_{new char[share()]};
};

class Refusing final : public Steady {
  mauve::Status on_configure() override { return mauve::invalid(gain, "is not to its liking"); }
};

class CrashingHook final : public Steady {
  mauve::Status on_configure() override {
    volatile int* volatile nobody = nullptr;
    *nobody = 1;
    return mauve::ok();
  }
};
/// Uses this much of the stack at once, from its far end on.
template <std::size_t kBytes>
class HookWithStack : public Steady {
  mauve::Status on_configure() override {
    volatile char memory[kBytes];
    for (std::size_t i = 0; i < kBytes; i += 1024) memory[i] = 1;
    static_cast<void>(memory[0]);
    return mauve::ok();
  }
};
struct RoomyHook final : HookWithStack<(std::size_t{7} << 20)> {};
struct OverflowingHook final : HookWithStack<(std::size_t{9} << 20)> {};

class LeavingHook final : public Steady {
  mauve::Status on_configure() override { std::exit(0); }
};

class ForkingHook final : public Steady {
  mauve::Status on_configure() override { return fork() == 0 ? mauve::ok() : mauve::ok(); }
};

class ThrowingHook final : public Steady {
  mauve::Status on_configure() override { throw std::runtime_error("no such device"); }
};

class ThrowingJob final : public Steady {
  void update() override { throw std::runtime_error("division by something"); }
};

/// Throws as soon as the file is there.
class Brittle final : public Steady {
  mauve::Property<std::string> until_there{*this, "until_there", "", "path of the file"};
  void update() override {
    if (std::filesystem::exists(until_there.get())) throw std::runtime_error("the file is there");
    Steady::update();
  }
};

/// Was well in build 1.
class Regressing final : public Steady {
  void update() override {
    if (NUMBER == 2) throw std::runtime_error("it was well before");
    Steady::update();
  }
};

struct NoText final : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return nullptr; }
};
class ThrowingNoText final : public Steady {
  mauve::Property<bool> in_job{*this, "in_job", false, "else when it is configured"};
  mauve::Status on_configure() override {
    if (!in_job) throw NoText();
    return mauve::ok();
  }
  void update() override { throw NoText(); }
};

class ThrowingAnything final : public Steady {
  mauve::Status on_configure() override { throw 42; }
};

/// Asks for a transaction in its first job.
class Requesting final : public Steady {
  mauve::Property<std::string> transaction{*this, "transaction", "deaf", "what it asks for"};
  mauve::Observable<bool> asked{*this, "asked", false, "and was heard"};
  mauve::Warning dull{*this, "dull", "it has nothing to ask for"};
  bool first_ = true;
  void update() override {
    Steady::update();
    if (std::exchange(first_, false)) asked = mauve::request(transaction.get());
  }
};

/// Asks in every job.
class Nagging final : public Steady {
  mauve::Property<std::string> transaction{*this, "transaction", "deaf", "what it asks for"};
  void update() override {
    Steady::update();
    static_cast<void>(mauve::request(transaction.get()));
  }
};

/// Uses so much time of its processor in every job, as the system counts it.
class Hungry final : public Steady {
  mauve::Property<mauve::Duration> uses{*this, "uses", std::chrono::microseconds(100)};

  static std::int64_t used() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
  }
  void update() override {
    const std::int64_t end = used() + uses.get().count();
    Steady::update();
    while (used() < end) {
    }
  }
};

/// Does work that takes so much time of an undisturbed processor in every job. The work is fixed:
/// what a host takes meanwhile comes on top.
class HardWorking final : public Steady {
  mauve::Property<mauve::Duration> uses{*this, "uses", std::chrono::microseconds(100)};
  std::int64_t rounds_ = 0;

  static std::int64_t work(std::int64_t rounds) {
    const auto begin = std::chrono::steady_clock::now();
    volatile std::uint64_t result = 1;
    std::uint64_t value = result;
    for (std::int64_t i = 0; i < rounds; ++i) value = value * 6364136223846793005U + 1;
    result = value;
    return (std::chrono::steady_clock::now() - begin).count();
  }
  mauve::Status on_configure() override {
    constexpr std::int64_t kRounds = 100'000;
    std::int64_t shortest = work(kRounds);
    for (int i = 0; i < 100; ++i) shortest = std::min(shortest, work(kRounds));
    rounds_ = uses.get().count() * kRounds / std::max<std::int64_t>(shortest, 1);
    return mauve::ok();
  }
  void update() override {
    Steady::update();
    work(rounds_);
  }
};

class Hanging final : public Steady {
  void update() override {
    shell().output.write(9.0);
    for (volatile bool for_ever = true; for_ever;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
};

/// Neither state nor statelessness declared.
class Forgetful final : public TrialCore {
  mauve::Property<double> gain{*this, "gain", 1.0, "written out"};
  void update() override {}
};

/// Its port lets out numbers only.
struct CheckedShell : mauve::Shell {
  mauve::WritePort<double> output{*this, "output", mauve::Safe{-1.0}, mauve::Plausible<double>{}};
};
/// Writes `bad` times a value that is no number, in all jobs together, and otherwise one.
class Checked : public mauve::Core<CheckedShell> {
 public:
  using Contract = Checked;
  static constexpr const char* contract = "trial/checked/1";

  virtual void update() {
    const bool wrong = state->count < bad;
    if (wrong) ++state->count;
    shell().output.write(wrong ? std::numeric_limits<double>::quiet_NaN() : 1.0);
  }

 private:
  mauve::State<Memory> state{*this};
  mauve::Property<std::int64_t> bad{*this, "bad", 0, "values that are no number"};
};
class CheckedAgain final : public Checked {};

struct AnotherShell : mauve::Shell {};
class AnotherCore : public mauve::Core<AnotherShell> {
 public:
  using Contract = AnotherCore;
  static constexpr const char* contract = "trial/another/1";
  void update() {}
};

}  // namespace
}  // namespace trial

MAUVE_PLUGIN(plugin) {
  plugin.core<trial::Steady>("steady");
  plugin.core<trial::Other>("other");
  if (NUMBER == 1) plugin.core<trial::Former>("former");
  plugin.core<trial::Noting>("noting");
  plugin.core<trial::Counting>("counting");
  plugin.core<trial::Undefined>("undefined");
  plugin.core<trial::Talking>("talking");
  plugin.core<trial::Slow>("slow");
  plugin.core<trial::Stuck>("stuck");
  plugin.core<trial::StuckConstructor>("stuck_constructor");
  plugin.core<trial::StuckDestructor>("stuck_destructor");
  plugin.core<trial::CrashingConstructor>("crashing_constructor");
  plugin.core<trial::ExitingConstructor>("exiting_constructor");
  plugin.core<trial::HoardingConstructor>("hoarding_constructor");
  plugin.core<trial::Brittle>("brittle");
  plugin.core<trial::Regressing>("regressing");
  plugin.core<trial::ThrowingAnything>("throwing_anything");
  plugin.core<trial::ThrowingNoText>("throwing_no_text");
  plugin.core<trial::Nagging>("nagging");
  plugin.core<trial::Refusing>("refusing");
  plugin.core<trial::ThrowingHook>("throwing_hook");
  plugin.core<trial::CrashingHook>("crashing_hook");
  plugin.core<trial::LeavingHook>("leaving_hook");
  plugin.core<trial::ForkingHook>("forking_hook");
  plugin.core<trial::RoomyHook>("roomy_hook");
  plugin.core<trial::OverflowingHook>("overflowing_hook");
  plugin.core<trial::ThrowingJob>("throwing_job");
  plugin.core<trial::Requesting>("requesting");
  plugin.core<trial::Hungry>("hungry");
  plugin.core<trial::HardWorking>("hard_working");
  plugin.core<trial::Hanging>("hanging");
  plugin.core<trial::Forgetful>("forgetful");
  plugin.core<trial::AnotherCore>("another");
  plugin.core<trial::Checked>("checked");
  plugin.core<trial::CheckedAgain>("checked_again");
  plugin.component<trial::CheckedShell, mauve::PeriodicFsm<trial::Checked>>("checked_unit",
                                                                            "checked");
  plugin.component<trial::TrialShell, mauve::PeriodicFsm<trial::TrialCore>>("unit", "steady");
  plugin.resource<mauve::EmptyShell, trial::MeterCore, trial::MeterInterface>("meter");
  plugin.resource<mauve::EmptyShell, trial::MuteCore, trial::MuteInterface>("mute");
  plugin.resource<mauve::EmptyShell, trial::FailingCore, trial::FailingInterface>("failing");
  plugin.resource<trial::TallyShell, trial::TallyCore, trial::TallyInterface>("tally");
}
