// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauved --check: the problems of a file, and whether its deadlines can be met.
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "arch/build/check_rules.h"
#include "arch/build/load.h"
#include "daemon.h"
#include "exec/admission/admission.h"
#include "log/json_text.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {
namespace {

/// "21.9 ms", "614 us", "2 s"; none: "-".
std::string in_words(const std::optional<Duration>& duration) {
  if (!duration) {
    return "-";
  }
  constexpr double kThreeDigits = 999.5;
  double count = std::chrono::duration<double, std::micro>(*duration).count();
  const char* unit = "us";
  for (const char* larger : {"ms", "s"}) {
    if (std::abs(count) < kThreeDigits) {
      break;
    }
    count /= 1000;
    unit = larger;
  }
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.3g %s", count, unit);
  return text.data();
}

void print_line(const std::array<std::string, 9>& cells) {
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), "%-16s %4s %4s %10s %-9s %10s %10s %10s %10s",
                cells[0].c_str(), cells[1].c_str(), cells[2].c_str(), cells[3].c_str(),
                cells[4].c_str(), cells[5].c_str(), cells[6].c_str(), cells[7].c_str(),
                cells[8].c_str());
  std::cout << line.data() << "\n";
}

/// The verdict on the table.
std::string verdict(const Timing& timing) {
  if (!timing.factor) {
    return "not proved: some execution times are not declared, or some components float";
  }
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(),
                *timing.factor < 1
                    ? "not proved: deadlines would be met with %.2f of the execution times"
                    : "proved: deadlines are met up to %.2f times the execution times",
                *timing.factor);
  return *timing.factor >= 1 && !timing.problems.empty() ? "not proved: see the warnings"
                                                         : text.data();
}

void print(const Timing& timing) {
  print_line(
      {"NAME", "CPU", "PRIO", "EXECUTION", "SOURCE", "BLOCKED", "RESPONSE", "DEADLINE", "SLACK"});
  for (const auto& one : timing.components) {
    print_line({one.name, one.cpu ? std::to_string(*one.cpu) : "-", std::to_string(one.priority),
                one.source == "unknown" ? "-" : in_words(one.execution), one.source,
                in_words(one.blocking), in_words(one.response), in_words(one.deadline),
                in_words(one.slack)});
  }
  std::cout << "execution time: processor time of a job; response time: elapsed, from its "
               "release to its end\n";
  for (const auto& lock : timing.locks) {
    if (lock.lock_budget) {
      std::cout << lock.resource << " is held for at most " << in_words(lock.lock_budget) << " ("
                << lock.source << ")\n";
    }
  }
  std::cout << verdict(timing) << "\n";
  for (const auto& problem : timing.problems) {
    std::cout << "warning: " << logging::printable(problem) << "\n";
  }
  for (const auto& note : timing.notes) {
    std::cout << "note: " << logging::printable(note) << "\n";
  }
}

void print_doubts(const plugin::Catalog& catalog) {
  for (const auto* loaded : catalog.plugins()) {
    for (const auto& warning : loaded->info().warnings) {
      std::cout << "note: plugin " << loaded->info().name << ": " << logging::printable(warning)
                << "\n";
    }
  }
}

}  // namespace

int check_file(const Options& options) {
  const auto text = arch::read_file(options.architecture);
  if (!text) {
    std::cerr << logging::printable(to_string(text.error())) << "\n";
    return 1;
  }
  plugin::Catalog catalog(options.plugin_dirs);
  arch::Problems problems;
  rules::Supervision supervision;
  const auto architecture = arch::load(*text, catalog, problems, &supervision);
  for (const auto& problem : problems.sorted()) {
    std::cerr << logging::printable(arch::to_string(problem, options.architecture)) << "\n";
  }
  if (!problems.empty()) {
    const auto count = problems.size();
    std::cerr << count << (count == 1 ? " error in " : " errors in ")
              << logging::printable(options.architecture) << "\n";
    return 1;
  }
  const std::string good = logging::printable(options.architecture) + ": no errors";
  if (architecture == nullptr || architecture->components().empty()) {
    std::cout << good << "\n";
    return 0;
  }
  const auto timing = exec::analyze(*architecture, options.machine);
  const auto notes = arch::notes_on_file(supervision, *architecture, catalog);
  std::cout << good;
  if (!notes.empty()) {
    std::cout << ", " << notes.size() << (notes.size() == 1 ? " note" : " notes")
              << " on connections and rules";
  }
  std::cout << "\n";
  print(timing);
  for (const auto& note : notes) {
    std::cout << "note: " << logging::printable(to_string(note)) << "\n";
  }
  print_doubts(catalog);
  if (options.admission == Admission::strict && !timing.problems.empty()) {
    std::cerr << "not admitted: " << logging::printable(timing.problems.front()) << "\n";
    return 1;
  }
  return 0;
}

}  // namespace mauve::daemon
