// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/recovery.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "arch/build/load.h"
#include "judge/judge.h"

namespace mauve::daemon {

namespace {

using logging::Event;

std::string folder_of(const std::string& file) {
  return std::filesystem::absolute(file).parent_path().string();
}

/// The result of a start with this generation.
struct StartTrial {
  Status survived = ok();  ///< code of a plugin crashed, hung or ended the process
  Status good = ok();      ///< the first error of the file
};

/// A core that failed on probation is never put in force, also not by a start from a generation
/// that was confirmed before.
Status check_cores(const Json& cores, const Json& quarantined) {
  for (const auto& one : cores) {
    for (const auto& out : quarantined) {
      if (out.value("core", "") == one["core"] && out.value("build_id", "") == one["build_id"]) {
        return refuse({Errc::wrong_state, "core_in_quarantine"},
                      one["component"].get<std::string>() + ".core",
                      out.value("core", "") +
                          " is in quarantine, since it failed: " + out.value("reason", ""),
                      "load a corrected build, or release it: mauvectl quarantine release " +
                          out.value("core", ""));
      }
    }
  }
  return ok();
}

/// The trial makes all elements once, in a process of its own. Code of a plugin that crashes there
/// does not end mauved, and a generation that cannot be made leaves nothing behind. If the process
/// cannot be started, or is late outside of any hook, as on a busy machine, the trial has no
/// verdict, and the start itself decides.
StartTrial trial_of(const Origin& origin, const Options& options, const Json& quarantined) {
  Question question{origin.text};
  question.loads = true;
  question.lists_cores = true;
  question.ran = origin.generation != 0;
  const auto judged = judge_apart(options, question);
  StartTrial trial;
  const bool late = !judged && judged.error().code == Errc::timed_out;
  if (late && judged.error().at == kWholeFile) {
    return trial;
  }
  if (!judged && died(judged.error())) {
    trial.survived = judged.error();
    if (judged.error().at == kWholeFile) {
      trial.survived.error().at = origin.file;
    }
  } else if (judged && judged->contains("errors") && !(*judged)["errors"].empty()) {
    const auto& first = (*judged)["errors"].front();
    const auto id = first.value("id", "");
    trial.good = refuse(Reason{Errc::invalid_value, id.c_str()}, first.value("at", origin.file),
                        first.value("message", ""), first.value("hint", ""));
  } else if (judged) {
    trial.good = check_cores(judged->value("cores", Json::array()), quarantined);
  }
  return trial;
}

/// Of one whose folder is no more the file of the command line may still know better.
std::string folder_of(const Generation& one, const Options& options) {
  std::error_code gone;
  return std::filesystem::is_directory(one.folder, gone) ? one.folder
                                                         : folder_of(options.architecture);
}

/// The crash counts for the newest confirmed generation of the architecture that was started, with
/// the components stopped that stay stopped. If there is none, the file of the command line was
/// started, which is remembered for it.
void count_crash(StateStore& store, std::uint64_t started, const Names& stopped,
                 logging::Log& log) {
  auto& generations = store.generations();
  const auto ran = generations.text(started);
  if (!ran) {
    return;
  }
  const auto same = text_with_stopped(*ran, stopped);
  const auto all = generations.list();
  auto counts = std::ranges::find_if(all, [&](const Generation& one) {
    const auto text = generations.text(one.number);
    return one.mark == Confirmation::confirmed && text && text_with_stopped(*text, stopped) == same;
  });
  if (counts == all.end()) {
    return store.last_run().file_crashed();
  }
  if (auto counted = generations.set_crashes(counts->number, counts->crashes + 1); !counted) {
    log.write(Event::run_not_recorded, {{"text", to_string(counted.error())}});
  }
}

/// The newest confirmed generation of the last system that can be started and crashed less than
/// `most` times.
std::optional<Origin> last_confirmed(const Options& options, StateStore& store,
                                     const LastSystem& last, unsigned most, logging::Log& log) {
  const auto& generations = store.generations();
  std::vector<std::string> passed_over;
  for (const auto& one : generations.list()) {
    const auto number = static_cast<std::int64_t>(one.number);
    if (one.mark != Confirmation::confirmed && !one.damaged) {
      continue;
    }
    Origin origin{generations.file(one.number).string(),
                  {},
                  folder_of(one, options),
                  one.number,
                  one.crashes};
    auto text = generations.text(one.number);
    if (text && name_in(*text) != last.name) {
      continue;  // another system
    }
    const auto starts = text ? text_with_stopped(*text, last.stopped) : std::string();
    if (text && (one.damaged || std::ranges::find(passed_over, starts) != passed_over.end())) {
      continue;  // of one that was damaged a moment ago the mark is not known
    }
    if (text && one.crashes >= most) {
      log.write(Event::generation_passed_over,
                {{"generation", number}, {"count", static_cast<std::int64_t>(one.crashes)}});
      passed_over.push_back(starts);
      continue;
    }
    auto usable = text ? ok() : Status(text.error());
    if (usable) {
      origin.text = *std::move(text);
      const auto trial = trial_of(origin, options, store.quarantined());
      usable = trial.survived ? trial.good : trial.survived;
    }
    if (usable) {
      const bool same = starts == text_with_stopped(origin.text, {});
      origin.replaces = one.command == kRecover && same ? one.number : 0;
      log.write(
          store.last_run().crashed() ? Event::generation_recovered : Event::generation_continued,
          {{"generation", number}, {"time", one.time}, {"file", options.architecture}});
      return origin;
    }
    log.write(Event::generation_unusable,
              {{"generation", number}, {"text", to_string(usable.error())}});
  }
  return std::nullopt;
}

/// All confirmed generations crashed, and so did the file: the one that crashed least.
std::optional<Origin> crashed_least(const Options& options, StateStore& store,
                                    const LastSystem& last, logging::Log& log) {
  auto least = std::numeric_limits<unsigned>::max();
  for (const auto& one : store.generations().list()) {
    const auto text = store.generations().text(one.number);
    if (one.mark == Confirmation::confirmed && text && name_in(*text) == last.name) {
      least = std::min(least, one.crashes);
    }
  }
  const bool any = least != std::numeric_limits<unsigned>::max();
  return any ? last_confirmed(options, store, last, least + 1, log) : std::nullopt;
}

std::string end_of_the_last_run(const StateStore& store) {
  return store.last_run().crashed() ? "the last run crashed" : "an upgrade restarted mauved";
}

/// A robot whose software is gone must not be driven by another system.
Status check_name(const std::string& text, const Options& options, const StateStore& store,
                  const LastSystem& last) {
  const auto name = name_in(text);
  if (last.generation == 0 || name.empty() || name == last.name) {
    return ok();
  }
  return refuse(
      {Errc::wrong_state, "other_system"}, options.architecture,
      "is of architecture \"" + name + "\", but \"" + last.name +
          "\" ran before: " + end_of_the_last_run(store) + ", and no saved generation of \"" +
          last.name + "\" can be started (the lines before say why). Nothing runs",
      "put the former build of the plugin in place, or a file of \"" + last.name +
          "\" at this path; the next start takes it. Only mauved --fresh starts \"" + name + "\"");
}

}  // namespace

Result<Origin> what_to_start(const Options& options, StateStore* store, logging::Log& log) {
  const auto last = store != nullptr ? last_system(store->generations()) : LastSystem();
  if (store != nullptr && store->last_run().crashed_generation() != 0) {
    count_crash(*store, store->last_run().crashed_generation(), last.stopped, log);
  }
  const bool recovers = store != nullptr &&
                        (store->last_run().crashed() || store->last_run().continues()) &&
                        !options.fresh;
  auto recovered =
      recovers ? last_confirmed(options, *store, last, kMostCrashes, log) : std::nullopt;
  if (recovers && !recovered && store->last_run().has_crashed(options.architecture)) {
    recovered = crashed_least(options, *store, last, log);
  }
  const auto stops = store != nullptr && !options.fresh ? store->stops().read() : UserStops();
  if (recovered) {
    recovered->stops = stops;
    recovered->stopped = last.stopped;
    recovered->stopped_in = last.generation;
    return *std::move(recovered);
  }
  auto text = arch::read_file(options.architecture);
  if (!text) {
    return text.error();
  }
  Origin origin{options.architecture, *std::move(text), folder_of(options.architecture)};
  origin.stops = stops;
  if (recovers) {
    if (auto same = check_name(origin.text, options, *store, last); !same) {
      return same.error();
    }
    log.write(Event::nothing_to_recover,
              {{"text", end_of_the_last_run(*store)}, {"file", options.architecture}});
    origin.stopped = last.stopped;
    origin.stopped_in = last.generation;
  }
  if (auto survived = trial_of(origin, options, Json()).survived; !survived) {
    return survived.error();
  }
  return origin;
}

}  // namespace mauve::daemon
