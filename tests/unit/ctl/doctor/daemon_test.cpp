// SPDX-License-Identifier: LGPL-3.0-or-later
// The facts that mauved reports about itself: rights, settings in force, directories.
#include <sys/stat.h>

#include "unit/ctl/doctor/machine.h"

namespace mauve::ctl::doctor {
namespace {

class DoctorOfMauved : public Machine {
 protected:
  DoctorOfMauved() { start_daemon(); }

  /// The caller is a user without rights.
  void write_caller(const std::string& rtprio, const std::string& memlock,
                    const std::string& capabilities) const {
    write("proc/self/limits", "Max locked memory         " + memlock + "   unlimited   bytes\n" +
                                  "Max realtime priority     " + rtprio + "   0");
    write("proc/self/status", "Uid:\t1000\t1000\t1000\t1000\nCapEff:\t" + capabilities);
  }
};

TEST_F(DoctorOfMauved, FindsNothingWhereAllIsWell) {
  for (const auto& check : checks()) {
    const auto finding = check.look(facts);
    EXPECT_NE(finding.grade, Grade::fail) << check.name << ": " << finding.found;
  }
  for (const auto look : {check_daemon, check_versions, check_priority_of_daemon,
                          check_locking_of_daemon, check_policy, check_guard, check_locked,
                          check_plugins, check_trust, check_state, check_space}) {
    const auto finding = look(facts);
    EXPECT_EQ(finding.grade, Grade::ok) << finding.found;
  }
}

TEST_F(DoctorOfMauved, WorksWithoutOne) {
  facts.daemon = facts.status = facts.version = nullptr;
  facts.no_daemon = "mauved is not reachable";

  expect(check_daemon(facts), Grade::warn, "no daemon: mauved is not reachable", "mauved FILE");
  for (const auto look :
       {check_priority_of_daemon, check_locking_of_daemon, check_policy, check_guard, check_locked,
        check_plugins, check_trust, check_state, check_space}) {
    expect(look(facts), Grade::ok, "no daemon");
  }
  for (const auto& check : checks()) EXPECT_NE(check.look(facts).grade, Grade::fail) << check.name;
}

TEST_F(DoctorOfMauved, SaysWhenAnOlderOneDoesNotKnowTheQuestion) {
  expect(check_daemon(facts), Grade::ok, "generation 41");
  facts.daemon = nullptr;
  facts.no_daemon = "unknown method";
  facts.hint = "command.list shows all methods";
  expect(check_daemon(facts), Grade::warn, "unknown method", "command.list");
}

TEST_F(DoctorOfMauved, ComparesVersions) {
  expect(check_versions(facts), Grade::ok, "mauvectl 0.1.0");
  facts.daemon["glibc"] = "2.35";
  expect(check_versions(facts), Grade::warn, "glibc 2.35", "restart mauved");
  facts.version["version"] = "0.0.9";
  expect(check_versions(facts), Grade::warn, "mauved 0.0.9", "install");
  facts.version["abi"] = kAbi + 1;
  expect(check_versions(facts), Grade::fail, "plugin ABI " + std::to_string(kAbi + 1), "install");
  facts.version["abi"] = kAbi;
  facts.version["protocol"] = {99};
  expect(check_versions(facts), Grade::fail, "protocol [99]", "install");
}

TEST_F(DoctorOfMauved, JudgesPriorities) {
  expect(check_priority_of_daemon(facts), Grade::ok, "RLIMIT_RTPRIO is 99");
  facts.daemon["rtprio"] = 90;
  expect(check_priority_of_daemon(facts), Grade::warn, "the guard needs 95", "@mauve - rtprio 99");
  facts.daemon["rtprio"] = 0;
  expect(check_priority_of_daemon(facts), Grade::fail, "no SCHED_FIFO thread", "rtprio 99");
  facts.daemon["service"] = true;
  expect(check_priority_of_daemon(facts), Grade::fail, "no SCHED_FIFO", "LimitRTPRIO=99");
  facts.daemon["realtime"] = "off";
  expect(check_priority_of_daemon(facts), Grade::warn, "no SCHED_FIFO", "LimitRTPRIO=99");
  facts.daemon["sys_nice"] = true;
  expect(check_priority_of_daemon(facts), Grade::ok, "CAP_SYS_NICE");
}

TEST_F(DoctorOfMauved, JudgesTheRightsOfTheCallerMoreMildly) {
  write_caller("0", "8388608", "0000000000000000");
  expect(check_priority_of_caller(facts), Grade::warn, "RLIMIT_RTPRIO is 0", "limits.conf");
  expect(check_locking_of_caller(facts), Grade::warn, "8192 KiB", "memlock unlimited");
  facts.group = "mauve-admin";
  expect(check_priority_of_caller(facts), Grade::warn, "RLIMIT_RTPRIO is 0",
         "@mauve-admin - rtprio 99");
  expect(check_locking_of_caller(facts), Grade::warn, "8192 KiB",
         "@mauve-admin - memlock unlimited");
  write_caller("99", "unlimited", "0000000000000000");
  expect(check_priority_of_caller(facts), Grade::ok, "RLIMIT_RTPRIO is 99");
  expect(check_locking_of_caller(facts), Grade::ok, "unlimited");
  write_caller("0", "0", "0000000000804000");
  expect(check_priority_of_caller(facts), Grade::ok, "CAP_SYS_NICE");
  expect(check_locking_of_caller(facts), Grade::ok, "CAP_IPC_LOCK");
}

TEST_F(DoctorOfMauved, JudgesTheLimitOfLockedMemory) {
  expect(check_locking_of_daemon(facts), Grade::ok, "unlimited");
  facts.daemon["memlock"] = 65536;
  expect(check_locking_of_daemon(facts), Grade::fail, "64 KiB", "@mauve - memlock unlimited");
  facts.daemon["service"] = true;
  expect(check_locking_of_daemon(facts), Grade::fail, "64 KiB", "LimitMEMLOCK=infinity");
  facts.daemon["realtime"] = "off";
  expect(check_locking_of_daemon(facts), Grade::warn, "64 KiB", "LimitMEMLOCK=infinity");
}

TEST_F(DoctorOfMauved, FindsAControlGroupWithoutRunTime) {
  expect(check_group(facts), Grade::ok, "does not divide");
  facts.daemon["cpu_group"] = "/robot";
  facts.daemon["rt_runtime_us"] = 950000;
  expect(check_group(facts), Grade::ok, "/sys/fs/cgroup/cpu/robot/cpu.rt_runtime_us is 950000");
  facts.daemon["rt_runtime_us"] = 0;
  expect(check_group(facts), Grade::fail, "refuses every SCHED_FIFO thread",
         "echo 950000 > /sys/fs/cgroup/cpu/robot/cpu.rt_runtime_us");
}

TEST_F(DoctorOfMauved, WarnsOfRunTimeThatVersion2OfControlGroupsCannotGive) {
  write("proc/sys/kernel/osrelease", "6.1.0-mine");
  write("boot/config-6.1.0-mine", "CONFIG_SMP=y\nCONFIG_RT_GROUP_SCHED=y");
  expect(check_group(facts), Grade::warn, "CONFIG_RT_GROUP_SCHED=y", "rt_group_sched=0");
  write("proc/cmdline", "quiet rt_group_sched=0");
  expect(check_group(facts), Grade::ok, "rt_group_sched=0");
}

TEST_F(DoctorOfMauved, FindsComponentsWithoutThePolicyTheyAskedFor) {
  expect(check_policy(facts), Grade::ok, "1 component");
  facts.status["components"][0]["realtime"] = false;
  expect(check_policy(facts), Grade::fail, "without SCHED_FIFO: control", "restart mauved");
  facts.daemon["rtprio"] = 0;
  expect(check_policy(facts), Grade::fail, "without SCHED_FIFO: control", "@mauve - rtprio 99");
  facts.daemon["service"] = true;
  expect(check_policy(facts), Grade::fail, "without SCHED_FIFO: control", "LimitRTPRIO=99");
  facts.daemon["realtime"] = "off";
  expect(check_policy(facts), Grade::warn, "--realtime off", "--realtime prefer");
}

TEST_F(DoctorOfMauved, LooksForTheGuard) {
  expect(check_guard(facts), Grade::ok, "SCHED_FIFO 95");
  facts.daemon["threads"][0]["policy"] = "SCHED_OTHER";
  expect(check_guard(facts), Grade::fail, "SCHED_OTHER", "restart mauved");
  facts.daemon["rtprio"] = 90;
  expect(check_guard(facts), Grade::fail, "SCHED_OTHER", "@mauve - rtprio 99");
  facts.daemon["threads"] = Json::array();
  expect(check_guard(facts), Grade::fail, "no thread mauve-guard", "restart");
  facts.daemon["realtime"] = "off";
  expect(check_guard(facts), Grade::warn, "--realtime off", "--realtime prefer");
  facts.daemon["realtime"] = "prefer";
  facts.status["components"] = Json::array();
  expect(check_guard(facts), Grade::ok, "no component");
}

TEST_F(DoctorOfMauved, SeesWhetherItsMemoryIsLocked) {
  expect(check_locked(facts), Grade::ok, "20 MiB");
  facts.daemon["locked_kib"] = 0;
  expect(check_locked(facts), Grade::fail, "nothing of mauved is locked", "restart mauved");
  facts.daemon["memlock"] = 65536;
  expect(check_locked(facts), Grade::fail, "nothing of mauved is locked",
         "@mauve - memlock unlimited");
  facts.daemon["realtime"] = "off";
  expect(check_locked(facts), Grade::warn, "--realtime off", "--realtime prefer");
}

TEST_F(DoctorOfMauved, JudgesThePluginDirectories) {
  expect(check_plugins(facts), Grade::ok, "/usr/lib/mauve/plugins (user 0, mode 0755)");
  facts.daemon["plugin_dirs"].push_back({{"path", "/opt/more"}, {"exists", false}});
  expect(check_plugins(facts), Grade::warn, "there is no /opt/more", "mkdir --parents /opt/more");
  facts.daemon["plugin_dirs"][0]["problem"] = "may be written by everybody";
  facts.daemon["plugin_dirs"][0]["hint"] = "chmod o-w /usr/lib/mauve/plugins";
  expect(check_plugins(facts), Grade::fail, "written by everybody", "chmod o-w");
}

TEST_F(DoctorOfMauved, JudgesTheSocketAndItsDirectory) {
  expect(check_socket(facts), Grade::ok, "there is no");
  write("run/mauve/mauved.sock", "");
  chmod((tree / "run/mauve/mauved.sock").c_str(), 0660);
  chmod((tree / "run/mauve").c_str(), 0750);
  expect(check_socket(facts), Grade::ok, "(mode 0660) in a directory of mode 0750");
  chmod((tree / "run/mauve/mauved.sock").c_str(), 0666);
  expect(check_socket(facts), Grade::warn, "open to everybody",
         "chmod 0660 /run/mauve/mauved.sock");
  chmod((tree / "run/mauve").c_str(), 0777);
  expect(check_socket(facts), Grade::fail, "everybody may replace", "chmod 0750 /run/mauve");
  chmod((tree / "run/mauve").c_str(), 01777);
  expect(check_socket(facts), Grade::warn, "open to everybody", "chmod 0660");
}

TEST_F(DoctorOfMauved, JudgesTheStateDirectory) {
  expect(check_state(facts), Grade::ok, "/var/lib/mauve (user 1000, mode 0750)");
  facts.status["saved"] = false;
  expect(check_state(facts), Grade::fail, "not saved", "mauvectl logs");
  facts.daemon["state_dir"]["mode"] = 0777;
  expect(check_state(facts), Grade::fail, "everybody may write", "chmod o-w /var/lib/mauve");
  facts.daemon["state_dir"] = {{"path", "/gone"}, {"exists", false}};
  expect(check_state(facts), Grade::fail, "there is no /gone", "mkdir");
  facts.daemon["state_dir"] = nullptr;
  expect(check_state(facts), Grade::warn, "none", "--state-dir");
}

TEST_F(DoctorOfMauved, JudgesTheSpaceOfTheStateDirectory) {
  expect(check_space(facts), Grade::ok, "7629 MiB of 8583 MiB");
  facts.daemon["state_dir"]["free_bytes"] = 100'000'000;
  expect(check_space(facts), Grade::warn, "95 MiB", "audit.log");
  facts.daemon["state_dir"]["free_bytes"] = 1000;
  expect(check_space(facts), Grade::fail, "0 MiB", "audit.log");
  facts.daemon["state_dir"] = nullptr;
  expect(check_space(facts), Grade::ok, "nothing is kept");
}

TEST_F(DoctorOfMauved, SeesPathsThatSomebodyElseMayExchange) {
  expect(check_trust(facts), Grade::ok, "nobody else");
  facts.daemon["distrusted"] = {{{"what", "architecture file"},
                                 {"path", "/srv"},
                                 {"problem", "may be written by everybody (it holds the file)"},
                                 {"hint", "chmod o-w /srv"}},
                                {{"what", "state directory"},
                                 {"path", "/srv"},
                                 {"problem", "may be written by everybody (it holds the state)"},
                                 {"hint", "chmod o-w /srv"}}};
  const auto finding = check_trust(facts);

  expect(finding, Grade::warn, "/srv may be written by everybody (it holds the file); /srv");
  EXPECT_EQ(finding.remedy, "chmod o-w /srv") << "said once";
}

}  // namespace
}  // namespace mauve::ctl::doctor
