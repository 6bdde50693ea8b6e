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
  /// It got an order to drive since this was asked last.
  [[nodiscard]] bool drives() {
    return eventually([&] { return has_driven(); });
  }
  /// It gets an order to drive from now on. Each component that stands is started: a guardian that
  /// gets no processor for 60 ms is replaced, and where one is required, all components stop then.
  [[nodiscard]] bool drives_when_started() {
    seen_ = base_.bytes().size();
    return eventually([&] {
      if (has_driven()) return true;
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
    return eventually([&] {
      const std::string& all = base_.bytes();
      return all.size() >= 5 && all.compare(all.size() - 5, 5, kStand) == 0;
    });
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
  Outlet base_;
  std::size_t seen_ = 0;
  std::optional<DaemonProcess> daemon_;

 private:
  [[nodiscard]] bool has_driven() {
    const std::string& all = base_.bytes();
    bool driven = false;
    for (auto at = all.find(kDrive, seen_); at != std::string::npos && at + 5 <= all.size();
         at = all.find(kDrive, at + 5)) {
      driven = driven || all.compare(at, 5, kStand) != 0;
      seen_ = at + 5;
    }
    return driven;
  }
};

}  // namespace mauve::test
