// SPDX-License-Identifier: LGPL-3.0-or-later
/// The command line of mauved.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "log/event.h"
#include "mauve/host/deploy_options.h"
#include "mauve/time.h"
#include "rt/guardian/guarded_outputs.h"

namespace mauve::daemon {

struct Options {
  std::string architecture;              ///< the file, as it was given: messages name it so
  std::string socket;                    ///< never empty
  std::vector<std::string> plugin_dirs;  ///< where plugins may come from, and nowhere else
  Realtime realtime = Realtime::prefer;
  rt::GuardianUse guardian = rt::GuardianUse::prefer;
  Admission admission = Admission::warn;
  MachineCosts machine = {};     ///< the costs that admission assumes
  Duration prepare_within{10s};  ///< for user code while a change is prepared
  bool check = false;            ///< only report the problems of the file
  bool judge = false;            ///< judge the question on standard input, for a mauved that runs
  std::vector<std::string> path_dirs;  ///< where requests may set paths to, too: path_rule.h
  std::string log_file;                ///< JSON lines; empty for none
  std::string state_dir;               ///< for data that outlives a run; empty: none is kept
  bool fresh = false;                  ///< start the file, also after a crash
  bool flight_recorder = true;         ///< traces always, and writes recordings by itself
  logging::Level log_level = logging::Level::info;

  /// SCHED_FIFO of [io], and of [control] while a stop is watched; 0: ordinary.
  [[nodiscard]] int urgency() const { return realtime == Realtime::off ? 0 : 1; }
  /// Of [stop], which watches them, and of [link] and [safe].
  [[nodiscard]] int urgency_of_watch() const { return realtime == Realtime::off ? 0 : 2; }
};

/// The program ends at once: --help, --version, or wrong use.
struct Leave {
  int exit = 0;      ///< 0, or 2 for wrong use
  std::string text;  ///< for stdout when exit is 0, else for stderr
};

/// [main] All paths but the architecture's are absolute: mauved goes to its folder, so that the
/// paths in it begin there. Never throws. Without --plugin-dir the only directory is
/// lib/mauve/plugins beside the program's own, or the installed one.
[[nodiscard]] std::variant<Options, Leave> parse_options(int argc, const char* const* argv);

/// As it is written there: "require", "prefer" or "off". [any]
[[nodiscard]] const std::string& word_of(Realtime realtime);

/// An option as the help shows it, for the manual.
struct OptionText {
  std::string name;       ///< "--socket", or that of an argument
  std::string value;      ///< "PATH"; empty: takes none
  std::string text;       ///< one sentence
  std::string otherwise;  ///< the default; empty: the text has it
};
[[nodiscard]] std::vector<OptionText> option_texts();

}  // namespace mauve::daemon
