// SPDX-License-Identifier: LGPL-3.0-or-later
/// A machine out of made-up files, and a mauved that is well on it.
#pragma once

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/checks.h"
#include "mauve/host/version.h"
#include "support/temp_dir.h"

namespace mauve::ctl::doctor {

class Machine : public testing::Test {
 protected:
  Machine() { facts.root = tree.path(); }

  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((tree / file).parent_path());
    static_cast<void>(tree.write(file, text + "\n"));
  }

  /// A mauved with a component on CPU 2, everything granted.
  void start_daemon() {
    facts.socket = "/run/mauve/mauved.sock";
    facts.client = "0.1.0";
    facts.glibc = "2.36";
    facts.daemon = {
        {"pid", 700},
        {"uid", 1000},
        {"service", false},
        {"realtime", "require"},
        {"rtprio", 99},
        {"memlock", nullptr},
        {"sys_nice", false},
        {"ipc_lock", false},
        {"locked_kib", 20480},
        {"cpu_group", ""},
        {"rt_runtime_us", nullptr},
        {"threads",
         {{{"name", "mauve-guard"}, {"policy", "SCHED_FIFO"}, {"priority", 95}, {"cpu", 0}}}},
        {"plugin_dirs",
         {{{"path", "/usr/lib/mauve/plugins"}, {"exists", true}, {"uid", 0}, {"mode", 0755}}}},
        {"state_dir",
         {{"path", "/var/lib/mauve"},
          {"exists", true},
          {"uid", 1000},
          {"mode", 0750},
          {"free_bytes", 8'000'000'000},
          {"total_bytes", 9'000'000'000}}},
        {"glibc", "2.36"}};
    facts.status = {{"generation", 41},
                    {"uptime_s", 61.0},
                    {"components",
                     {{{"name", "control"}, {"priority", 20}, {"cpus", {2}}, {"realtime", true}}}}};
    facts.version = {{"version", "0.1.0"}, {"protocol", {protocol::kVersion}}, {"abi", kAbi}};
  }

  test::TempDir tree;
  Facts facts;
};

/// A finding that is well has no remedy, each other one has.
inline void expect(const Finding& finding, Grade grade, const std::string& found,
                   const std::string& remedy = {}) {
  EXPECT_EQ(to_string(finding.grade), to_string(grade)) << finding.found;
  EXPECT_THAT(finding.found, testing::HasSubstr(found));
  EXPECT_THAT(finding.remedy, testing::HasSubstr(remedy));
  EXPECT_EQ(finding.remedy.empty(), grade == Grade::ok) << finding.remedy;
}

}  // namespace mauve::ctl::doctor
