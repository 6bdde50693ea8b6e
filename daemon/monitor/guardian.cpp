// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/guardian.h"

#include <filesystem>
#include <string>

#include "base/duration.h"
#include "commands/answer.h"
#include "commands/audit.h"
#include "commands/change/change.h"
#include "commands/change/stop.h"
#include "commands/model.h"
#include "commands/say.h"
#include "commands/stops.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using How = rt::GuardianState::How;
using What = rt::GuardianNews::What;

/// Both are installed in the same folder.
std::string program() {
  std::error_code failed;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", failed);
  return (own.parent_path() / "mauve-guardian").string();
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

std::string who_was_silent() {
  const auto component = rt::starved_component();
  return component.empty() ? "mauved was silent" : component + " got no processor";
}

std::string found_text(const rt::GuardianNews& news) {
  std::string text =
      news.state.how == How::service ? "the guardian service" : "a guardian of its own";
  const auto names = rt::GuardedOutputs::of_process().names();
  text += " (process " + std::to_string(news.state.process) + ") " +
          (names.empty() ? "serves, without outputs yet" : "holds " + listed(names));
  if (news.lasted > Duration{0}) {
    text += "; for " + format_duration(std::chrono::round<std::chrono::milliseconds>(news.lasted)) +
            " there was none";
  }
  if (!news.state.why.empty()) {
    text += "; " + news.state.why;
  }
  return text;
}

}  // namespace

Status Guardian::start(const Options& options) {
  rt::GuardianPlan plan;
  use_ = options.guardian;
  plan.use = options.guardian;
  plan.socket = options.socket + ".guardian";
  plan.command = {program(), "--connected"};
  plan.priority = options.urgency_of_watch();
  auto begun = link_.start(std::move(plan), [this](const rt::GuardianNews& news) { report(news); });
  return begun && use_ == rt::GuardianUse::require ? link_.found_at_start() : begun;
}

/// On the thread of the link. A stop comes before the words about it.
void Guardian::report(const rt::GuardianNews& news) {
  const auto names = rt::GuardedOutputs::of_process().names();
  const auto outputs = names.empty() ? "the outputs" : listed(names);
  switch (news.what) {
    case What::found:
      return log_.write(Event::guardian_found, {{"text", found_text(news)}});
    case What::absent:
      return log_.write(Event::guardian_absent, {{"outputs", outputs}, {"text", news.state.why}});
    case What::lost: {
      const bool stops = use_ == rt::GuardianUse::require && !names.empty();
      if (stops) {
        cause_ = "the required guardian was lost";
        stop_all();
      }
      log_.write(Event::guardian_lost, {{"outputs", outputs}, {"text", news.state.why}});
      if (stops) log_.write(Event::outputs_unguarded, {{"outputs", outputs}});
      return;
    }
    case What::silence:
      cause_ = "the guardian took the outputs in a standstill";
      stop_all();
      return log_.write(Event::outputs_made_safe,
                        {{"text", who_was_silent()},
                         {"lasted", format_duration(news.lasted)},
                         {"done", static_cast<std::int64_t>(news.done)},
                         {"total", static_cast<std::int64_t>(news.total)}});
  }
}

void Guardian::serve(Running& running) {
  running_ = &running;
  stop_all();  // it may have been silent before there was anything to stop
}

/// Until the stop is in force components go on, with live outputs: so the orders are sent once
/// more.
void Guardian::stop_all() {
  Running* const running = running_;
  if (running == nullptr) {
    return;
  }
  const char* const cause = cause_.exchange(nullptr);
  if (cause == nullptr) {
    return;
  }
  const auto order = std::make_shared<StopOrder>(std::vector<std::string>(), nullptr, nullptr);
  if (running->stopper != nullptr) {
    running->stopper->watch(order);  // [control] may be held up
  }
  running->control.urgent([running, cause, order] {
    order->begin();
    const FromLookToAct still(*running);
    note_place_failures(*running);
    const auto call = call_by_itself(*running, cause);
    call->order = order;
    std::vector<arch::Line> lines;
    std::vector<std::string> runs;
    for (const auto* component : running->architecture.components()) {
      const auto& name = component->name();
      ++running->stops[name];
      running->stops_came[name] = std::chrono::steady_clock::now();
      if (running->deployer.status(name).state == ComponentState::running) {
        lines.push_back(arch::make_line("start", name + ".start", true, false));
        runs.push_back(name);
      }
    }
    order->found(std::move(runs));
    const UserStop by{0, logging::utc(std::chrono::system_clock::now()), 0, cause};
    auto stopping = running->deployer.begin_stop_all(2s, by);
    static_cast<void>(save_stops(*running));
    when_answered(
        *running, call, std::move(stopping), [running, call, lines, order](Ongoing& done) {
          order->end(running->deployer);
          rt::GuardedOutputs::of_process().send_again();
          const auto receipt = done.result();
          auto result = receipt ? Result<Json>(answer_to_stop(*call, *receipt)) : receipt.error();
          if (result) {
            say_lines(lines, *result);
          }
          answer(*running, *call, std::move(result), "safe");
        });
  });
}

Json Guardian::json() const {
  const auto state = link_.state();
  const auto names = rt::GuardedOutputs::of_process().names();
  if (names.empty()) {
    return Json();
  }
  Json row = {{"outputs", names}, {"present", state.how != How::none}};
  if (state.how == How::none) {
    const Duration since{MonotonicClock().now() - state.since};
    row["why"] = state.why;
    row["absent_s"] = std::chrono::duration<double>(since).count();
  } else {
    row["process"] = state.process;
    row["service"] = state.how == How::service;
  }
  return row;
}

}  // namespace mauve::daemon
