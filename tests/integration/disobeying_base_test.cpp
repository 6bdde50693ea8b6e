// SPDX-License-Identifier: LGPL-3.0-or-later
// etc/rover.json with a base that the test plays: it obeys no command, or falls silent.
#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "support/daemon_process.h"
#include "support/eventually.h"
#include "support/fake_base.h"
#include "support/temp_dir.h"

namespace mauve::test {
namespace {

void replace_all(std::string& text, std::string_view old, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += with.size()) {
    text.replace(at, old.size(), with);
  }
}

/// The shipped file with this device of the base, and absolute paths.
std::string rover_with(const std::string& device) {
  const std::string etc = MAUVE_ETC_DIR;
  std::string text = TempDir::read(etc + "/rover.json");
  replace_all(text, "\"maps/", "\"" + etc + "/maps/");
  replace_all(text, R"("core.device": "pty:base")", R"("core.device": ")" + device + '"');
  return text;
}

/// The shipped rover on a base of the test, and the answers of the client about it.
class RoverBase : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(rover_.up()) << rover_.errors(); }

  [[nodiscard]] std::string state() const {
    const auto status = rover_.ask({"status"});
    const auto& all = status["components"];
    const auto its =
        std::find_if(all.begin(), all.end(), [](const auto& one) { return one["name"] == "base"; });
    return its == all.end() ? std::string() : (*its)["state"].get<std::string>();
  }
  /// `status` has a note about this warning of the base.
  [[nodiscard]] bool status_says(const std::string& warning, const std::string& text) const {
    const auto status = rover_.ask({"status"});
    const auto& notes = status["notes"];
    return std::any_of(notes.begin(), notes.end(), [&](const auto& one) {
      return one["address"] == "base.core." + warning && contains(one["text"], text);
    });
  }
  /// `why` has it among the events of the base.
  [[nodiscard]] bool why_says(const std::string& text) const {
    const auto why = rover_.ask({"why", "base"});
    const auto& records = why["records"];
    return std::any_of(records.begin(), records.end(),
                       [&](const auto& one) { return contains(one["text"], text); });
  }
  static bool contains(const std::string& all, const std::string& text) {
    return all.find(text) != std::string::npos;
  }

  FakeBase base_;
  TempDir place_;
  DaemonProcess rover_{place_.write("rover.json", rover_with(base_.path()))};
};

TEST_F(RoverBase, IsStoppedByARuleWhileItObeysNoCommandUntilItIsStarted) {
  ASSERT_TRUE(eventually([&] { return rover_.value("base.core.frames") > 100; }));
  EXPECT_EQ(state(), "running");
  EXPECT_EQ(rover_.value("base.core.disobeys"), false);

  base_.report(4);
  EXPECT_TRUE(eventually([&] { return state() == "stopped"; })) << rover_.ask({"rules"});
  const std::string reason = "its base is in mode 4 and obeys no command";
  EXPECT_TRUE(status_says("disobeys", reason)) << rover_.ask({"status"});
  EXPECT_TRUE(eventually([&] { return why_says(reason); })) << rover_.ask({"why", "base"});
  EXPECT_EQ(rover_.ask({"why", "base"})["change"]["reason"], "by rule base_disobeys");

  base_.report(2);
  ASSERT_EQ(rover_.ask({"start", "base"})["state"], "applied");
  EXPECT_TRUE(eventually(
      [&] { return state() == "running" && rover_.value("base.core.disobeys") == false; }));
}

/// No rule stops the base, since its driver lets it stand by itself.
TEST_F(RoverBase, StandsWhileItIsSilentAndIsDrivenAgainOnceItReports) {
  ASSERT_TRUE(eventually([&] { return base_.drives() > 100; })) << rover_.errors();

  base_.fall_silent(true);
  const int before = rover_.value("base.core.timeouts");  // the machine may have stood still
  EXPECT_TRUE(eventually([&] { return rover_.value("base.core.timeouts") >= before + 2; }));
  const auto driven = base_.drives();
  const std::string reason = "its base sends nothing";
  EXPECT_TRUE(eventually([&] { return status_says("silent", reason); })) << rover_.errors();
  EXPECT_TRUE(eventually([&] { return why_says(reason); })) << rover_.ask({"why", "base"});
  EXPECT_EQ(state(), "running");
  EXPECT_EQ(base_.drives(), driven);

  base_.fall_silent(false);
  EXPECT_TRUE(eventually([&] { return base_.drives() > driven; }));
  EXPECT_TRUE(eventually([&] { return !status_says("silent", ""); }));
}

}  // namespace
}  // namespace mauve::test
