// SPDX-License-Identifier: LGPL-3.0-or-later
#include "judge/judge.h"

#include <signal.h>
#include <string.h>

#include <memory>
#include <utility>

#include "base/duration.h"
#include "base/mutex.h"
#include "protocol/message.h"

namespace mauve::daemon {

namespace {

/// A process on a slow and busy machine; from then on it looks at the time itself.
constexpr Duration kToBegin = 10s;
constexpr const char* kUntouched =
    "nothing of it came near the running system: correct the plugin, or take another file";

/// "first.core constructor": the address becomes that of the refusal.
Error lost(Reason reason, const std::string& hook, const std::string& happened) {
  const auto space = hook.find(' ');
  const bool placed = space != std::string::npos;
  const std::string what = placed ? hook.substr(space + 1) : hook.empty() ? "its code" : hook;
  return refuse(reason, placed ? hook.substr(0, space) : kWholeFile, what + " " + happened,
                kUntouched);
}

Error error_of(const Json& said) {
  return {protocol::errc_named(said.value("name", "")).value_or(Errc::system),
          said.value("where", ""), said.value("message", ""), said.value("hint", ""),
          said.value("id", "")};
}

std::string signal_name(int signal) {
  const char* name = sigabbrev_np(signal);
  return name == nullptr ? "signal " + std::to_string(signal) : std::string("SIG") + name;
}

}  // namespace

Result<Json> verdict_of(const rt::ChildEnd& end, Duration within) {
  using Ended = rt::ChildEnd::How;
  if (end.how == Ended::cancelled) {
    return refuse({Errc::wrong_state, "mauved_ends"}, "mauved",
                  "is about to end, so the file was not judged");
  }
  const bool by_its_timer = end.how == Ended::signalled && end.code == SIGALRM;
  if (end.how == Ended::late || by_its_timer) {
    return lost({Errc::timed_out, "hook_hung_apart"}, end.errors,
                "did not return within " + format_duration(within) +
                    ", so the process in which it was tried was ended");
  }
  if (end.how == Ended::signalled) {
    return lost({Errc::plugin_refused, "code_died_apart"}, end.errors,
                "ended the process in which it was tried: " + signal_name(end.code));
  }
  const auto said = Json::parse(end.output, nullptr, false);
  if (said.is_object() && said.contains("judgement")) {
    return said["judgement"];
  }
  if (said.is_object() && said.contains("refused")) {
    return error_of(said["refused"]);
  }
  return lost(
      {Errc::plugin_refused, "code_died_apart"}, end.errors,
      "ended the process in which it was tried, with exit code " + std::to_string(end.code));
}

std::vector<std::string> judge_command(const Options& options) {
  std::vector<std::string> words = {"/proc/self/exe", "-", "--judge", "--prepare-within",
                                    format_duration(options.prepare_within)};
  for (const auto& directory : options.plugin_dirs) {
    words.insert(words.end(), {"--plugin-dir", directory});
  }
  return words;
}

Result<Json> judge_apart(const Options& options, const Question& question) {
  rt::ChildRunner runner;
  const auto end = runner.run(judge_command(options), protocol::to_line(to_json(question)),
                              options.prepare_within + kToBegin);
  return end ? verdict_of(*end, options.prepare_within) : end.error();
}

bool died(const Error& verdict) {
  return verdict.code == Errc::plugin_refused || verdict.code == Errc::timed_out;
}

void Judge::start(std::vector<std::string> command, Duration within) {
  command_ = std::move(command);
  within_ = within;
  thread_.start();
}

void Judge::stop() {
  runner_.cancel();
  thread_.stop();
}

void Judge::ask(const Asker& asker, const Question& question, Then then) {
  if (auto slot = claim_slot(asker.uid); !slot) {
    control_.read([then = std::move(then), error = slot.error()] { then(error); });
    return;
  }
  thread_.post(
      [this, user = asker.uid, text = protocol::to_line(to_json(question)),
       then = std::move(then)]() mutable {
        auto result = std::make_shared<Result<Json>>(judged(text));
        release_slot(user);
        control_.read([then = std::move(then), result] { then(std::move(*result)); });
      },
      asker);
}

Result<Json> Judge::judged(const std::string& question) {
  const auto end = runner_.run(command_, question, within_ + kToBegin);
  if (!end) {
    return end.error();
  }
  return verdict_of(*end, within_);
}

Status Judge::claim_slot(uid_t user) {
  const MutexLock lock(mutex_);
  auto& waiting = waiting_[user];
  if (waiting == kMostOfOneUser) {
    return refuse({Errc::limit, "too_many_judged"}, "file",
                  std::to_string(kMostOfOneUser) + " files of yours are being judged already",
                  "try again when they are done");
  }
  ++waiting;
  return ok();
}

void Judge::release_slot(uid_t user) {
  const MutexLock lock(mutex_);
  if (--waiting_[user] == 0) {
    waiting_.erase(user);
  }
}

}  // namespace mauve::daemon
