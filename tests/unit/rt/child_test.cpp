// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/child.h"

#include <gtest/gtest.h>

#include <csignal>
#include <future>

namespace mauve::rt {
namespace {

using How = ChildEnd::How;

constexpr Duration kLong = 60s;

ChildEnd run_shell(const std::string& script, const std::string& input = "",
                   Duration within = kLong) {
  ChildRunner runner;
  const auto end = runner.run({"/bin/sh", "-c", script}, input, within);
  EXPECT_TRUE(end);
  return end ? *end : ChildEnd{};
}

TEST(Child, ReadsItsInputAndItsOutputIsReturned) {
  const std::string text(300'000, 'x');

  const auto end = run_shell("cat; echo wrong >&2; exit 4", text);

  EXPECT_EQ(end.how, How::exited);
  EXPECT_EQ(end.code, 4);
  EXPECT_EQ(end.output, text);
  EXPECT_EQ(end.errors, "wrong\n");
}

TEST(Child, ThatIsLateIsEndedWithAllThatItStarted) {
  const auto end = run_shell("trap 'echo last words' TERM; sleep 1000 & wait", "", 2s);

  EXPECT_EQ(end.how, How::late);
  EXPECT_EQ(end.output.substr(0, 11), "last words\n") << "a slow shell may be told twice";
}

TEST(Child, ReportsTheSignalThatEndsIt) {
  const auto end = run_shell("kill -ABRT $$");

  EXPECT_EQ(end.how, How::signalled);
  EXPECT_EQ(end.code, SIGABRT);
}

TEST(Child, HasDefaultSignalsAndNoOtherDescriptor) {
  const auto end = run_shell("ls /proc/self/fd | tr '\\n' ' '; grep SigIgn /proc/self/status");

  EXPECT_EQ(end.output.find("0 1 2 3 "), 0U) << end.output;  // the last one is of ls
  const auto ignored = end.output.find("SigIgn:");
  ASSERT_NE(ignored, std::string::npos) << end.output;
  const auto signals = std::stoull(end.output.substr(ignored + 8), nullptr, 16);
  EXPECT_EQ(signals & 0x7fffffffU, 0U) << "of 1 to 31; the C library keeps 32 and 33 for itself";
}

TEST(Child, IsCancelledFromAnotherThread) {
  ChildRunner runner;
  auto running = std::async(std::launch::async, [&] {
    return runner.run({"/bin/sleep", "1000"}, "", kLong);
  });

  runner.cancel();

  const auto end = running.get();
  EXPECT_TRUE(!end || end->how == How::cancelled) << "before it began, or after";
  EXPECT_FALSE(runner.run({"/bin/true"}, "", kLong)) << "nor any later one";
}

TEST(Child, ThatIsNoProgramIsRefused) {
  ChildRunner runner;

  const auto end = runner.run({"/nowhere/program"}, "", kLong);

  ASSERT_FALSE(end);
  EXPECT_NE(end.error().message.find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace mauve::rt
