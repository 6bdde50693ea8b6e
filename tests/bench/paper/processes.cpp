// SPDX-License-Identifier: LGPL-3.0-or-later
/// Runs of the tasks in programs of other middleware.
#include <csignal>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/paper/tasks.h"

namespace bench::paper {
namespace {

/// A child whose standard output is read to its end. It ends with this process, and with this
/// object.
class Child {
 public:
  Child(const std::vector<std::string>& command, int cpu) {
    int ends[2];
    if (pipe(ends) != 0) return;
    const pid_t parent = getpid();
    child_ = fork();
    if (child_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(127);
      stay_on(cpu);
      dup2(ends[1], STDOUT_FILENO);
      close(ends[0]);
      close(ends[1]);
      std::vector<char*> words;
      for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
      words.push_back(nullptr);
      execv(words[0], words.data());
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (output_ >= 0) close(output_);
    if (child_ <= 0) return;
    kill(child_, SIGKILL);  // nothing, when it has ended
    waitpid(child_, nullptr, 0);
  }
  /// The output of the process until its end, or until the instant.
  [[nodiscard]] std::string all(Instant until) const {
    std::string text;
    char piece[4096];
    pollfd output{output_, POLLIN, 0};
    for (Instant left = until - now(); left > 0; left = until - now()) {
      if (poll(&output, 1, static_cast<int>(left / 1'000'000) + 1) <= 0) continue;
      const ssize_t count = read(output_, piece, sizeof piece);
      if (count <= 0) return text;
      text.append(piece, static_cast<std::size_t>(count));
    }
    std::fprintf(stderr, "paper: process %d did not end and is killed\n", child_);
    return text;
  }

 private:
  pid_t child_ = -1;
  int output_ = -1;
};

void parse(const std::string& output, Run& run) {
  std::istringstream lines(output);
  std::string name;
  while (lines >> name) {
    if (name == "launch") {
      Instant when = 0;
      lines >> name >> when;
      (name == kA.name ? run.launched_a : run.launched_b) = when;
      continue;
    }
    Cycle cycle{};
    lines >> cycle.start >> cycle.end;
    (name == kA.name ? run.a : run.b).push_back(cycle);
  }
}

std::string microseconds(Duration time) { return std::to_string(time.count() / 1000); }

std::vector<std::string> command(const std::string& program, const Task& task, Duration time) {
  return {program,
          "cycles",
          task.name,
          microseconds(task.period),
          microseconds(task.time),
          std::to_string(time / task.period)};
}

/// For a run of so long, and to come up and say what it did.
Instant latest(Duration time) { return now() + 2 * time.count() + 60'000'000'000; }

}  // namespace

Run run_processes(const std::string& program, int cpu, Duration time) {
  Run run;
  const Instant until = latest(time);
  run.launched_a = now();
  const Child a(command(program, kA, time), cpu);
  run.launched_b = now();
  const Child b(command(program, kB, time), cpu);
  parse(a.all(until), run);
  parse(b.all(until), run);
  return run;
}

Run run_process(const std::string& program, const std::string& variant, int cpu, Duration time) {
  Run run;
  const Child both({program, variant, std::to_string(cpu), std::to_string(time / kA.period)}, cpu);
  parse(both.all(latest(time)), run);
  return run;
}

std::string output_of(const std::vector<std::string>& words, int cpu) {
  return Child(words, cpu).all(latest(std::chrono::minutes(1)));
}

}  // namespace bench::paper
