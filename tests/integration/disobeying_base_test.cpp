// SPDX-License-Identifier: LGPL-3.0-or-later
// etc/rover.json with a base that the test plays: it reports, and obeys no command.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "support/daemon_process.h"
#include "support/eventually.h"
#include "support/outlet.h"
#include "support/temp_dir.h"

namespace mauve::test {
namespace {

/// Reports a mode each 15 ms, and that its wheels stand.
class ReportingBase {
 public:
  ReportingBase() : thread_([this] { run(); }) {}
  ~ReportingBase() {
    ends_ = true;
    thread_.join();
  }
  ReportingBase(const ReportingBase&) = delete;
  ReportingBase& operator=(const ReportingBase&) = delete;

  [[nodiscard]] const std::string& path() const { return line_.path(); }
  void report(int mode) { mode_ = mode; }

 private:
  void run() {
    while (!ends_) {
      std::array<char, 13> frame{19, 10, 7, 0, 35, 0, 43, 0, 0, 44, 0, 0, 0};
      frame[5] = static_cast<char>(mode_.load());
      unsigned sum = 0;
      for (const char byte : frame) sum += static_cast<unsigned char>(byte);
      frame.back() = static_cast<char>(256U - sum % 256U);
      static_cast<void>(!write(line_.descriptor(), frame.data(), frame.size()));
      line_.bytes();  // commands, which find room again
      std::this_thread::sleep_for(std::chrono::milliseconds(15));
    }
  }

  Outlet line_;
  std::atomic<int> mode_{2};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

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
  ReportingBase base;
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
