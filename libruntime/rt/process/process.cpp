// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/process.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

#include <linux/capability.h>
#include <linux/sched.h>

#include "rt/process/fifo.h"

namespace mauve::rt {
namespace {

constexpr std::uint64_t kKernelThread = 0x00200000;  // PF_KTHREAD of the kernel's sched.h

template <typename T>
T number_in(std::string_view text, int base = 10) {
  T value{};
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream stream{std::string(text)};
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string policy_named(int policy) {
  switch (policy) {
    case SCHED_FIFO:
      return "SCHED_FIFO";
    case SCHED_RR:
      return "SCHED_RR";
    case SCHED_BATCH:
      return "SCHED_BATCH";
    case SCHED_IDLE:
      return "SCHED_IDLE";
    case SCHED_DEADLINE:
      return "SCHED_DEADLINE";
    default:
      return "SCHED_OTHER";
  }
}

/// The rest of the line that begins with `title`.
std::string_view after(std::string_view text, std::string_view title) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with(title)) return line.substr(title.size());
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return {};
}

std::string first_word(std::string_view text) {
  const auto words = words_of(text);
  return words.empty() ? std::string{} : words.front();
}

void read_limits(std::string_view limits, ProcessFacts& facts) {
  const std::string priority = first_word(after(limits, "Max realtime priority"));
  facts.priority_limit = priority == "unlimited" ? 99 : number_in<std::uint64_t>(priority);
  const std::string memory = first_word(after(limits, "Max locked memory"));
  if (memory != "unlimited") facts.lock_limit = number_in<std::uint64_t>(memory);
}

void read_status(std::string_view status, ProcessFacts& facts) {
  const auto users = words_of(after(status, "Uid:"));
  facts.root = users.size() > 1 && users[1] == "0";
  const auto held = number_in<std::uint64_t>(first_word(after(status, "CapEff:")), 16);
  facts.nice_capability = (held >> CAP_SYS_NICE & 1U) != 0;
  facts.lock_capability = (held >> CAP_IPC_LOCK & 1U) != 0;
}

/// VmLck of `status` counts address space, including pages that nothing has touched yet.
std::uint64_t locked_kib(const std::filesystem::path& folder, std::string_view status) {
  const auto sums = file_text(folder / "smaps_rollup");
  return number_in<std::uint64_t>(
      first_word(sums ? after(*sums, "Locked:") : after(status, "VmLck:")));
}

}  // namespace

std::optional<std::string> file_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream.is_open()) return std::nullopt;
  std::string text;
  for (char piece[4096]; stream.read(piece, sizeof piece) || stream.gcount() > 0;) {
    text.append(piece, static_cast<std::size_t>(stream.gcount()));
  }
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return text;
}

std::optional<ThreadFacts> thread_facts(std::string_view line, std::string_view status) {
  // "12 (its name) R ...": the name may hold anything.
  const auto begin = line.find('(');
  const auto end = line.rfind(") ");
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return {};
  // proc(5): 3 state, 9 flags, 10 minflt, 12 majflt, 14 utime, 15 stime, 39 processor,
  // 40 rt_priority, 41 policy.
  const auto words = words_of(line.substr(end + 2));
  if (words.size() < 39) return std::nullopt;
  ThreadFacts thread;
  thread.id = number_in<int>(line);
  thread.name = line.substr(begin + 1, end - begin - 1);
  thread.kernel = (number_in<std::uint64_t>(words[6]) & kKernelThread) != 0;
  thread.minor_faults = number_in<std::uint64_t>(words[7]);
  thread.major_faults = number_in<std::uint64_t>(words[9]);
  thread.ticks = number_in<std::uint64_t>(words[11]) + number_in<std::uint64_t>(words[12]);
  thread.cpu = number_in<int>(words[36]);
  thread.priority = number_in<int>(words[37]);
  thread.policy = policy_named(number_in<int>(words[38]));
  const auto count = [&](std::string_view title) {
    return number_in<std::uint64_t>(first_word(after(status, title)));
  };
  thread.waits = count("voluntary_ctxt_switches:");
  thread.preemptions = count("nonvoluntary_ctxt_switches:");
  return thread;
}

std::vector<ThreadFacts> threads_of(const std::filesystem::path& root, std::string_view process) {
  std::vector<ThreadFacts> threads;
  std::error_code failed;
  const auto folder = root / "proc" / process / "task";
  // A process that ends meanwhile is one that has no more threads.
  for (std::filesystem::directory_iterator one(folder, failed), end; !failed && one != end;
       one.increment(failed)) {
    const auto line = file_text(one->path() / "stat");
    auto thread =
        line ? thread_facts(*line, file_text(one->path() / "status").value_or("")) : std::nullopt;
    if (!thread) continue;
    thread->process = number_in<int>(process);
    threads.push_back(*std::move(thread));
  }
  std::sort(threads.begin(), threads.end(),
            [](const ThreadFacts& a, const ThreadFacts& b) { return a.id < b.id; });
  return threads;
}

ProcessFacts process_facts(const std::filesystem::path& root, std::string_view process) {
  const auto folder = root / "proc" / process;
  ProcessFacts facts;
  facts.lock_limit = 0;
  if (const auto limits = file_text(folder / "limits")) {
    facts.lock_limit = std::nullopt;
    read_limits(*limits, facts);
  }
  const auto status = file_text(folder / "status").value_or("");
  read_status(status, facts);
  facts.locked_kib = locked_kib(folder, status);
  const auto group = cpu_group(file_text(folder / "cgroup").value_or(""));
  if (!group) return facts;
  facts.cpu_group = *group;
  const auto budget = file_text(root / ("sys/fs/cgroup/cpu" + *group) / "cpu.rt_runtime_us");
  if (budget) facts.group_runtime_us = number_in<std::int64_t>(*budget);
  return facts;
}

}  // namespace mauve::rt
