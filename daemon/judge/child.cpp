// SPDX-License-Identifier: LGPL-3.0-or-later
#include "judge/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <new>
#include <string>

#include "judge/judgement.h"
#include "model/job/abandonable_thread.h"
#include "plugin/load/plugin_file.h"
#include "rt/process/child.h"
#include "rt/thread/run_guarded.h"

namespace mauve::daemon {

namespace {

constexpr std::size_t kLongestAnswer = std::size_t{8} << 20;
constexpr unsigned kHandlerMayTake = 1;  // seconds, when memory that it needs is locked
constexpr std::array kEnds = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGXCPU, SIGALRM};

/// Its standard error, which a plugin does not get.
int its_errors = -1;

/// Async-signal-safe enough for a process that is lost: should it hang, the alarm ends it. A hook
/// that it interrupts may not call alarm().
void say_the_hook() {
  rt::forget_bodies();
  alarm(kHandlerMayTake);
  const auto* here = AbandonableThread::here();
  const auto hook = here == nullptr ? std::string() : here->hook();
  static_cast<void>(!write(its_errors, hook.data(), hook.size()));
}

void say_the_hook_and_end(int signal) {
  say_the_hook();
  raise(signal);  // its handler is the default one again
}

void catch_ends() {
  static std::array<char, 65536> stack;
  const stack_t its_own{stack.data(), 0, stack.size()};
  sigaltstack(&its_own, nullptr);
  struct sigaction action {};
  action.sa_handler = say_the_hook_and_end;
  action.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND);
  for (const int signal : kEnds) {
    sigaction(signal, &action, nullptr);
  }
  std::atexit(say_the_hook);
}

/// From now on, without the time that the process took to begin.
void end_after(Duration time) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(time - seconds);
  const itimerval once{{0, 0}, {seconds.count(), rest.count()}};
  setitimer(ITIMER_REAL, &once, nullptr);
}

/// The output of plugins is discarded. Returns the descriptor for the answer.
int keep_streams() {
  const int answer = dup(STDOUT_FILENO);
  its_errors = dup(STDERR_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  return answer;
}

Result<Json> answer_to(const std::string& text, const Options& options) {
  try {
    const auto question = question_of(text);
    if (!question) {
      return refuse({Errc::invalid_value, "judge_misused"}, "--judge",
                    "standard input holds no question",
                    "mauved runs this by itself; to check a file: mauved --check FILE");
    }
    return judge(*question, plugin::Catalog(options.plugin_dirs));
  } catch (const std::bad_alloc&) {
    return refuse({Errc::limit, "file_needs_too_much"}, "file",
                  "its elements need more than a quarter of the memory of this machine",
                  "a file of that size is checked with mauved --check FILE");
  }
}

Json error_json(const Error& error) {
  return {{"name", to_string(error.code)},
          {"where", error.at},
          {"message", error.message},
          {"hint", error.hint},
          {"id", error.id}};
}

/// The length of the answer is bounded.
std::string line_of(const Json& said) {
  auto line = protocol::to_line(said);
  if (line.size() <= kLongestAnswer) {
    return line;
  }
  return protocol::to_line(
      Json{{"refused",
            error_json(refuse({Errc::limit, "judge_answer_too_long"}, kWholeFile,
                              "there is more to say of it than fits", "compare a smaller file"))}});
}

void write_all(int file, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const auto part = write(file, text.data() + written, text.size() - written);
    if (part <= 0) {
      return;
    }
    written += static_cast<std::size_t>(part);
  }
}

}  // namespace

int judge_as_child(const Options& options) {
  // The longest file that it writes is the sealed copy of a plugin.
  rt::confine({rt::quarter_of_memory(), plugin::kLargestPlugin, options.prepare_within});
  const int answer = keep_streams();
  catch_ends();
  AbandonableThread here;
  here.begin_here();
  const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
  end_after(options.prepare_within);
  const auto judged = answer_to(text, options);
  const Json said =
      judged ? Json{{"judgement", *judged}} : Json{{"refused", error_json(judged.error())}};
  write_all(answer, line_of(said));
  _exit(0);  // no code of a plugin runs after the answer
}

}  // namespace mauve::daemon
