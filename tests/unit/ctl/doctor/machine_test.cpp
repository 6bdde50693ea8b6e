// SPDX-License-Identifier: LGPL-3.0-or-later
// The kernel and the machine, from files in the form of /proc and /sys.
#include "unit/ctl/doctor/machine.h"

namespace mauve::ctl::doctor {
namespace {

class DoctorOfTheMachine : public Machine {
 protected:
  void write_thread(const std::string& process, const std::string& thread, const std::string& name,
                    unsigned flags, int priority, int ticks = 0) const {
    write("proc/" + process + "/task/" + thread + "/stat",
          thread + " (" + name + ") S 1 1 1 0 -1 " + std::to_string(flags) + " 0 0 0 0 " +
              std::to_string(ticks) + " 0 0 0 -2 0 1 0 9 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 " +
              std::to_string(priority) + (priority > 0 ? " 1" : " 0") + " 0 0 0");
  }
  void write_cpus(int count) const {
    for (int cpu = 0; cpu < count; ++cpu) {
      std::filesystem::create_directories(tree / (kCpus + "cpu" + std::to_string(cpu)));
    }
    std::filesystem::create_directories(tree / (kCpus + "cpufreq"));
  }

  const std::string kCpus = "sys/devices/system/cpu/";
};

TEST_F(DoctorOfTheMachine, JudgesThrottling) {
  expect(check_throttling(facts), Grade::ok, "not to be read");
  write("proc/sys/kernel/sched_rt_period_us", "1000000");
  write("proc/sys/kernel/sched_rt_runtime_us", "950000");
  expect(check_throttling(facts), Grade::ok, "950000 of 1000000 us");
  write("proc/sys/kernel/sched_rt_runtime_us", "-1");
  expect(check_throttling(facts), Grade::ok, "off");
  write("proc/sys/kernel/sched_rt_runtime_us", "500000");
  expect(check_throttling(facts), Grade::warn, "500000 of", "sysctl -w kernel.sched_rt_runtime_us");
  write("proc/sys/kernel/sched_rt_runtime_us", "0");
  expect(check_throttling(facts), Grade::fail, "0 of", "sysctl -w kernel.sched_rt_runtime_us");
}

TEST_F(DoctorOfTheMachine, KnowsPreemptionModels) {
  write("sys/kernel/realtime", "1");
  expect(check_preemption(facts), Grade::ok, "PREEMPT_RT");
  write("sys/kernel/realtime", "0");
  write("proc/version", "Linux version 6.1 #1 SMP PREEMPT_RT Debian");
  expect(check_preemption(facts), Grade::ok, "PREEMPT_RT");
  write("proc/version", "Linux version 6.1 #1 SMP PREEMPT_DYNAMIC Debian");
  expect(check_preemption(facts), Grade::warn, "model not to be read", "preempt=full");
  write("proc/cmdline", "preempt=full");
  expect(check_preemption(facts), Grade::ok, "PREEMPT_DYNAMIC, full");
  write("sys/kernel/debug/sched/preempt", "none (voluntary) full");
  expect(check_preemption(facts), Grade::warn, "PREEMPT_DYNAMIC, voluntary", "preempt=full");
}

TEST_F(DoctorOfTheMachine, ReadsThePreemptionModelOfAFixedKernel) {
  write("proc/version", "Linux version 6.1 #1 SMP");
  write("proc/sys/kernel/osrelease", "6.1");
  expect(check_preemption(facts), Grade::warn, "none or voluntary", "linux-image-rt-");
  write("boot/config-6.1", "# CONFIG_PREEMPT is not set\nCONFIG_PREEMPT_NONE=y");
  expect(check_preemption(facts), Grade::warn, "none:", "linux-image-rt-");
  write("boot/config-6.1", "CONFIG_PREEMPT=y");
  expect(check_preemption(facts), Grade::ok, "full");
}

TEST_F(DoctorOfTheMachine, NamesForeignUrgentThreadsButNotOurs) {
  start_daemon();
  write_thread("2", "2", "migration/0", 0x00200040, 99);
  write_thread("700", "701", "control", 0x400040, 20);
  write_thread("10", "10", "bash", 0x400000, 0);
  expect(check_foreign(facts), Grade::ok, "none, beside 1 thread of the kernel");

  write_thread("800", "812", "pipe(wire", 0x400040, 10);
  expect(check_foreign(facts), Grade::ok, "less urgent than every component");
  write_thread("800", "812", "pipe(wire", 0x400040, 88);
  expect(check_foreign(facts), Grade::warn,
         "pipe(wire (process 800, SCHED_FIFO 88, CPU 1, used 0 s)", "chrt --other --pid 0 812");
  write("proc/800/comm", "pipewire");
  expect(check_foreign(facts), Grade::warn, "pipe(wire (pipewire 800,", "chrt --other --pid 0 812");
  write("proc/800/comm", "mauved");
  expect(check_foreign(facts), Grade::warn, "(mauved 800,", "end mauved 800, or give it");
}

TEST_F(DoctorOfTheMachine, TakesNoRealTimeFromTheGuardian) {
  start_daemon();
  write("proc/600/comm", "mauve-guardian");
  write_thread("600", "600", "mauve-guardian", 0x400040, 98);
  expect(check_foreign(facts), Grade::ok, "none, beside 0 threads of the kernel");
}

TEST_F(DoctorOfTheMachine, NamesTheForeignThreadFirstThatUsedTheProcessorMost) {
  for (int i = 1; i <= 8; ++i) {
    write_thread("900", std::to_string(900 + i), "probe" + std::to_string(i), 0, 90);
  }
  write_thread("900", "999", "busy", 0, 60, 5700);

  const auto finding = check_foreign(facts);

  EXPECT_THAT(finding.found,
              testing::StartsWith("busy (process 900, SCHED_FIFO 60, CPU 1, used 57 s)"));
}

TEST_F(DoctorOfTheMachine, CountsForeignThreadsThatAreTooManyToName) {
  for (int i = 1; i <= 8; ++i) {
    write_thread("900", std::to_string(900 + i), "x" + std::to_string(i), 0, 40 + i);
  }

  const auto finding = check_foreign(facts);

  expect(finding, Grade::warn, "x8 (process 900, SCHED_FIFO 48", "chrt");
  EXPECT_THAT(finding.found, testing::HasSubstr("and 3 more"));
}

TEST_F(DoctorOfTheMachine, JudgesHugePages) {
  expect(check_huge_pages(facts), Grade::ok, "no transparent ones");
  write("sys/kernel/mm/transparent_hugepage/enabled", "always [madvise] never");
  expect(check_huge_pages(facts), Grade::ok, "madvise");
  write("sys/kernel/mm/transparent_hugepage/enabled", "[always] madvise never");
  expect(check_huge_pages(facts), Grade::warn, "always",
         "echo madvise > /sys/kernel/mm/transparent_hugepage/enabled");
}

TEST_F(DoctorOfTheMachine, JudgesSwapByWhetherMemoryIsLocked) {
  write("proc/swaps", "Filename Type Size Used Priority");
  expect(check_swap(facts), Grade::ok, "off");
  write("proc/swaps", "Filename Type Size Used Priority\n/dev/sda2 partition 9 0 -2");
  expect(check_swap(facts), Grade::warn, "1 area", "swapoff --all");
  start_daemon();
  expect(check_swap(facts), Grade::ok, "memory of mauved is locked");
}

TEST_F(DoctorOfTheMachine, JudgesTheClockSource) {
  const std::string folder = "sys/devices/system/clocksource/clocksource0/";
  expect(check_clock(facts), Grade::warn, "not to be read", "cat /sys");
  write(folder + "current_clocksource", "tsc");
  expect(check_clock(facts), Grade::ok, "tsc");
  write(folder + "current_clocksource", "hpet");
  write(folder + "available_clocksource", "hpet acpi_pm");
  expect(check_clock(facts), Grade::warn, "hpet", "tsc=reliable");
  write(folder + "available_clocksource", "hpet tsc acpi_pm");
  expect(check_clock(facts), Grade::warn, "hpet", "echo tsc > /" + folder);
}

TEST_F(DoctorOfTheMachine, JudgesTheGovernor) {
  write_cpus(2);
  expect(check_frequency(facts), Grade::ok, "does not change it");
  write(kCpus + "cpu0/cpufreq/scaling_governor", "performance");
  write(kCpus + "cpu1/cpufreq/scaling_governor", "performance");
  expect(check_frequency(facts), Grade::ok, "2 CPUs");
  write(kCpus + "cpu1/cpufreq/scaling_governor", "powersave");
  expect(check_frequency(facts), Grade::warn, "cpu1 powersave", "echo performance | tee");
}

TEST_F(DoctorOfTheMachine, ComparesIsolatedCpusWithThoseOfComponents) {
  write_cpus(2);
  expect(check_isolation(facts), Grade::ok, "too few");
  write_cpus(8);
  expect(check_isolation(facts), Grade::ok, "none of 8 CPUs");
  start_daemon();
  expect(check_isolation(facts), Grade::warn, "share CPU 2",
         "isolcpus=managed_irq,domain,2 nohz_full=2");
  expect(check_isolation(facts), Grade::warn, "share CPU 2", "CPUAffinity=0-7");
  write(kCpus + "isolated", "2");
  write(kCpus + "nohz_full", "(null)");
  expect(check_isolation(facts), Grade::warn, "timer tick on CPU 2", "nohz_full=2");
  write(kCpus + "nohz_full", "2");
  expect(check_isolation(facts), Grade::ok, "CPU 2 set apart");
  write(kCpus + "isolated", "2-3");
  expect(check_isolation(facts), Grade::warn, "no component uses CPU 3", "\"cpus\": [3]");
  write(kCpus + "isolated", "6-7");
  expect(check_isolation(facts), Grade::warn, "components run on CPU 2", "\"cpus\": [6]");
  expect(check_isolation(facts), Grade::warn, "components run on CPU 2", "CPUAffinity=0-7");
  facts.status["components"][0]["cpus"] = Json::array();
  expect(check_isolation(facts), Grade::warn, "not for control", "\"cpus\": [6]");
}

TEST_F(DoctorOfTheMachine, JudgesSleepStates) {
  write_cpus(1);
  expect(check_sleep(facts), Grade::ok, "none");
  write(kCpus + "cpu0/cpuidle/state0/latency", "2");
  write(kCpus + "cpu0/cpuidle/state0/disable", "0");
  expect(check_sleep(facts), Grade::ok, "at most 2 us");
  write(kCpus + "cpu0/cpuidle/state1/latency", "133");
  write(kCpus + "cpu0/cpuidle/state1/disable", "0");
  expect(check_sleep(facts), Grade::warn, "at most 133 us", "echo 1 > $s/disable");
  write(kCpus + "cpu0/cpuidle/state1/disable", "1");
  expect(check_sleep(facts), Grade::ok, "at most 2 us");
}

TEST_F(DoctorOfTheMachine, ReadsWhatTheMachineIsHeldTo) {
  write_cpus(1);
  write(kCpus + "cpu0/cpuidle/state1/latency", "133");
  write("dev/cpu_dma_latency", std::string("\x0a\0\0\0", 4));
  expect(check_sleep(facts), Grade::ok, "/dev/cpu_dma_latency is 10 us");
  write("dev/cpu_dma_latency", std::string("\xff\xff\xff\x7f", 4));
  expect(check_sleep(facts), Grade::warn, "at most 133 us", "disable");
}

TEST_F(DoctorOfTheMachine, WarnsOfTimeThatAHostTook) {
  write("proc/cpuinfo", "flags : fpu tsc");
  write("proc/stat", "cpu  100 0 50 800 0 0 0 0 0 0");
  expect(check_virtual(facts), Grade::ok, "no");
  write("proc/cpuinfo", "flags : fpu hypervisor tsc");
  expect(check_virtual(facts), Grade::ok, "its host took no time");
  write("proc/stat", "cpu  100 0 50 1000000 0 0 0 1 0 0");
  expect(check_virtual(facts), Grade::ok, "less than 0.01 %");
  write("proc/stat", "cpu  100 0 50 800 0 0 0 50 77 0\ncpu0 1 1 1 1 1 1 1 1 1 1");
  expect(check_virtual(facts), Grade::warn, "5.00 %", "virsh vcpupin");
}

TEST_F(DoctorOfTheMachine, JudgesAnEmptyTreeWithoutAFall) {
  for (const auto& check : checks()) EXPECT_NE(check.look(facts).grade, Grade::fail) << check.name;
}

TEST(CpuLists, AreReadAndWritten) {
  EXPECT_EQ(cpus_in("0-2,5,7-8"), (std::vector<int>{0, 1, 2, 5, 7, 8}));
  EXPECT_EQ(cpus_in(""), std::vector<int>{});
  EXPECT_EQ(cpus_in("(null)"), std::vector<int>{});
  EXPECT_LE(cpus_in("0-999999999999").size(), 1024U);
  EXPECT_EQ(cpu_list({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  EXPECT_EQ(cpu_list({}), "");
}

}  // namespace
}  // namespace mauve::ctl::doctor
