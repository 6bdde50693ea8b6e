// SPDX-License-Identifier: LGPL-3.0-or-later
// etc/rover.json with a base that the test plays: it reports, and obeys no command.
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

TEST(RoverRules, StopABaseThatObeysNoCommandUntilItIsStarted) {
  FakeBase base;
  const TempDir place;
  DaemonProcess rover(place.write("rover.json", rover_with(base.path())));
  ASSERT_TRUE(rover.up()) << rover.errors();
  const auto state = [&] {
    const auto status = rover.ask({"status"});
    const auto& all = status["components"];
    const auto its =
        std::find_if(all.begin(), all.end(), [](const auto& one) { return one["name"] == "base"; });
    return its == all.end() ? std::string() : (*its)["state"].get<std::string>();
  };
  ASSERT_TRUE(eventually([&] { return rover.value("base.core.frames") > 100; }));
  EXPECT_EQ(state(), "running");
  EXPECT_EQ(rover.value("base.core.disobeys"), false);

  base.report(4);
  EXPECT_TRUE(eventually([&] { return state() == "stopped"; })) << rover.ask({"rules"});

  base.report(2);
  ASSERT_EQ(rover.ask({"start", "base"})["state"], "applied");
  EXPECT_TRUE(eventually(
      [&] { return state() == "running" && rover.value("base.core.disobeys") == false; }));
}

}  // namespace
}  // namespace mauve::test
