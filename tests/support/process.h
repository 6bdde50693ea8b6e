// SPDX-License-Identifier: LGPL-3.0-or-later
/// A process of a test, ended with it.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>
#include <utility>
#include <vector>

#include "support/eventually.h"

extern char** environ;

namespace mauve::test {

/// A child process whose standard output can be read line by line without waiting.
class Process {
 public:
  /// The standard error of the child goes to the file `errors`, or is discarded.
  Process(std::vector<std::string> words, const std::string& errors = "/dev/null") {
    std::array<int, 2> pipe_ends{};
    if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return;
    output_ = pipe_ends[0];
    fcntl(output_, F_SETFL, O_NONBLOCK);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
    // A test may run in the background of a script, which ignores these for it.
    sigset_t usual;
    sigemptyset(&usual);
    for (const int one : {SIGINT, SIGQUIT, SIGHUP}) sigaddset(&usual, one);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&id_, arguments[0], &actions, &attributes, arguments.data(), environ) != 0) {
      id_ = 0;
    }
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe_ends[1]);
  }
  ~Process() {
    if (running()) kill(id_, SIGKILL);
    (void)wait();
    if (output_ >= 0) ::close(output_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  [[nodiscard]] bool running() {
    if (id_ > 0 && waitpid(id_, &status_, WNOHANG) == id_) id_ = 0;
    return id_ > 0;
  }
  [[nodiscard]] pid_t id() const { return id_; }
  void signal(int number) {
    if (running()) kill(id_, number);
  }
  /// Exit code once it has ended; 128 and the signal when it was killed.
  int wait() {
    if (id_ > 0) waitpid(std::exchange(id_, 0), &status_, 0);
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }
  /// The complete lines that arrived since the last call.
  std::vector<std::string> lines() {
    std::array<char, 65536> bytes{};
    for (ssize_t n = 0; (n = ::read(output_, bytes.data(), bytes.size())) > 0;) {
      pending_.append(bytes.data(), static_cast<std::size_t>(n));
    }
    std::vector<std::string> complete;
    for (std::size_t end = 0; (end = pending_.find('\n')) != std::string::npos;) {
      complete.push_back(pending_.substr(0, end));
      pending_.erase(0, end + 1);
    }
    return complete;
  }
  /// Everything until it ends.
  std::string all_output() {
    std::string text;
    const auto take = [&] {
      const bool ended = !running();
      for (const std::string& line : lines()) text += line + "\n";
      return ended;
    };
    if (!eventually(take)) text += "(still running)";
    return text + pending_;
  }

 private:
  pid_t id_ = 0;
  int status_ = 0;
  int output_ = -1;
  std::string pending_;
};

}  // namespace mauve::test
