// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resources of the plugin "trial", and the state that it keeps: NUMBER says which build this is.
#pragma once

#include <mauve/plugin.h>

#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <type_traits>

namespace trial {

struct MemoryV1 {
  std::int64_t count = 0;
};
struct MemoryV2 {
  double spare = 0;
  std::int64_t count = 0;
};
using Memory = std::conditional_t<NUMBER == 3, MemoryV2, MemoryV1>;

}  // namespace trial

template <>
struct mauve::Described<trial::MemoryV1> {
  static constexpr std::string_view name = "trial_memory/1";
  static constexpr auto fields() { return std::tuple{field("count", &trial::MemoryV1::count)}; }
};
template <>
struct mauve::Described<trial::MemoryV2> {
  static constexpr std::string_view name = "trial_memory/2";
  static constexpr auto fields() {
    return std::tuple{field("spare", &trial::MemoryV2::spare),
                      field("count", &trial::MemoryV2::count)};
  }
};

namespace trial {
namespace {

/// Returns when the file that is named in the environment is gone.
void wait_for_file_to_go() {
  const char* const path = std::getenv("MAUVE_TRIAL_WAITS");
  while (path != nullptr && std::filesystem::exists(path)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// A resource that does not let its caller go when it is given this value.
class MeterCore final : public mauve::Core<mauve::EmptyShell> {
 public:
  void note(const double& value) {
    for (volatile bool for_ever = value == breaks_at.get(); for_ever;) {
    }
  }
  double limit() { return breaks_at.get(); }
  void stamp(const MemoryV2& value) { stamped = value.count; }

 private:
  mauve::Stateless stateless_{*this};
  mauve::Property<double> breaks_at{*this, "breaks_at", 4.0, "hangs when it is given this value"};
  mauve::Property<MemoryV2> mark{*this, "mark", {}, "a structure"};
  mauve::Property<mauve::Bounded<MemoryV2, 4>> marks{*this, "marks", {}, "several structures"};
  mauve::Observable<std::int64_t> stamped{*this, "stamped", 0, "the count of the last stamp"};
};
struct MeterInterface : mauve::Interface<MeterCore> {
  mauve::WriteService<double> write{*this, "write", &MeterCore::note};
  mauve::ReadService<double> read{*this, "read", &MeterCore::limit};
  mauve::WriteService<MemoryV2> stamp{*this, "stamp", &MeterCore::stamp};
};

/// A resource that counts what it is given, and shows which build it is of.
struct TallyShell : mauve::Shell {
  mauve::Property<std::int64_t> size{*this, "size", 7, "of the shell"};
};
class TallyCore final : public mauve::Core<TallyShell> {
 public:
  void note(const double& /*value*/) {
    count = ++state->count;
    number = NUMBER;
    size = shell().size;
  }
  double scaled(double value, std::int64_t by) { return gain * value * static_cast<double>(by); }
  void forget() { count = state->count = 0; }

 private:
  mauve::State<Memory> state{*this};
#if NUMBER == 3
  mauve::Converts<MemoryV1, Memory> from_v1{
      state, [](const MemoryV1& old, Memory& now) noexcept { now.count = old.count; }};
#endif
  mauve::Property<double> gain{*this, "gain", 1.0, "kept"};
  mauve::Observable<std::int64_t> count{*this, "count", 0, "calls so far"};
  mauve::Observable<std::int64_t> number{*this, "number", 0, "of the build"};
  mauve::Observable<std::int64_t> size{*this, "size", 0, "of the shell, as met"};
};
struct TallyInterface : mauve::Interface<TallyCore> {
  mauve::WriteService<double> note{*this, "note", &TallyCore::note};
  mauve::CallService<double(double, std::int64_t)> scaled{*this, "scaled", &TallyCore::scaled};
  mauve::EventService<> forget{*this, "forget", &TallyCore::forget};
};

/// A resource whose value is computed, and that does not answer while the file of the environment
/// is there. Like code that waits in the system, it cannot be interrupted meanwhile.
class MuteCore final : public mauve::Core<mauve::EmptyShell> {
 public:
  double value() {
    if (const char* const path = std::getenv("MAUVE_TRIAL_WAITS"); path != nullptr) {
      std::ofstream(std::string(path) + ".met") << "waiting";
    }
    sigset_t all{};
    sigset_t before{};
    sigfillset(&all);
    // Not by pthread_sigmask(), which keeps the signals of mauve out of the mask.
    constexpr std::size_t kSignalBytes = 8;
    syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, &before, kSignalBytes);
    wait_for_file_to_go();
    syscall(SYS_rt_sigprocmask, SIG_SETMASK, &before, nullptr, kSignalBytes);
    return 1.0;
  }

 private:
  mauve::Stateless stateless_{*this};
};
struct MuteInterface : mauve::Interface<MuteCore> {
  mauve::ReadService<double> read{*this, "read", &MuteCore::value};
};

/// A resource whose value is computed by code that fails as its property says.
class FailingCore final : public mauve::Core<mauve::EmptyShell> {
 public:
  double value() {
    if (how.get() == "throws") throw std::runtime_error("no bearing");
    if (how.get() == "crashes") *null = 1;
    if (how.get() == "exits") std::exit(3);
    for (volatile bool for_ever = how.get() == "loops"; for_ever;) {
    }
    return 1.0;
  }

 private:
  volatile int* null = nullptr;
  mauve::Stateless stateless_{*this};
  mauve::Property<std::string> how{*this, "how", "answers",
                                   "answers, throws, crashes, exits, loops"};
};
struct FailingInterface : mauve::Interface<FailingCore> {
  mauve::ReadService<double> read{*this, "read", &FailingCore::value};
};

}  // namespace
}  // namespace trial
