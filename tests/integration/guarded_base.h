// SPDX-License-Identifier: LGPL-3.0-or-later
/// A base on a pseudo-terminal, and a mauved that drives it: the bytes on its line are looked at
/// from outside.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "support/daemon_process.h"
#include "support/fake_base.h"
#include "support/guarded.h"

namespace mauve::test {

using Json = nlohmann::json;

class GuardedBase : public testing::Test {
 protected:
  void start(std::vector<std::string> more = {"--realtime", "off"}) {
    const auto file = place_.write("guarded.json", guarded_architecture(base_.path()).dump());
    daemon_.emplace(file, std::move(more));
    ASSERT_TRUE(daemon_->up()) << daemon_->errors();
  }
  /// It gets an order to drive from now on.
  [[nodiscard]] bool drives() const { return drives(base_); }
  [[nodiscard]] static bool drives(const FakeBase& base) {
    const auto before = base.drives();
    return eventually([&] { return base.drives() > before; });
  }
  /// The same. Each component that stands is started: a guardian that gets no processor for 60 ms
  /// is replaced, and where one is required, all components stop then.
  [[nodiscard]] bool drives_when_started() const {
    const auto before = base_.drives();
    return eventually([&] {
      if (base_.drives() > before) return true;
      const Json status = daemon_->ask({"status"});
      if (!status.is_object()) return false;
      for (const Json& one : status.value("components", Json::array())) {
        if (one["state"] == "stopped") {
          static_cast<void>(daemon_->client({"start", "cruise", "base"}).wait());
          break;
        }
      }
      return false;
    });
  }
  /// Its last order is to stand.
  [[nodiscard]] bool stands() {
    return eventually([&] { return base_.bytes().ends_with(kStand); });
  }
  [[nodiscard]] Json guardian() const {
    const Json status = daemon_->ask({"status"});
    return status.is_object() ? status.value("guardian", Json::object()) : Json::object();
  }
  /// The one that holds the output; see drives_when_started().
  [[nodiscard]] Json present_guardian() const {
    Json found;
    EXPECT_TRUE(eventually([&] {
      found = guardian();
      return found.value("present", false) && found["outputs"] == Json::array({"base.core.stand"});
    })) << found
        << daemon_->errors();
    return found;
  }

  TempDir place_;
  FakeBase base_;
  std::optional<DaemonProcess> daemon_;
};

}  // namespace mauve::test
