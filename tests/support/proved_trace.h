// SPDX-License-Identifier: LGPL-3.0-or-later
/// The trace of a mauved in the last seconds of its test obeys the model: `mauvectl
/// check-trace`.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "support/mauvectl.h"

namespace mauve::test {

/// It records nothing, or does not answer: it hangs, or is about to start or to end.
inline bool has_no_trace(const std::string& answer) {
  const auto json = nlohmann::json::parse(answer, nullptr, false);
  if (!json.is_object() || !json.contains("error")) return false;
  const auto& error = json["error"];
  const std::string name = error.value("name", "");
  return name == "unreachable" || name == "timed_out" ||
         (name == "wrong_state" && error.value("message", "") == "nothing is traced");
}

/// How long a job takes is up to the machine that the tests run on: the campaign of the rover
/// judges responses, and no other test does.
inline bool only_late(const std::string& verdict) {
  const auto json = nlohmann::json::parse(verdict, nullptr, false);
  if (!json.is_object() || !json.contains("violations_of")) return false;
  return json["violations_of"].size() == 1 && json["violations_of"].contains("response");
}

/// One that is gone, or has no trace, is not asked.
inline void expect_trace_obeys_the_model(const std::string& socket, Process& daemon,
                                         const std::filesystem::path& place) {
  if (!daemon.running()) return;
  const std::string file = (place / "end.mtrace").string();
  const std::string errors = (place / "end.txt").string();
  const Said dumped =
      mauvectl(socket, {"--json", "--timeout", "2s", "trace", "dump", "-o", file}, errors);
  if (dumped.exit != 0) {
    if (!has_no_trace(dumped.out)) ADD_FAILURE() << "no trace to check: " << dumped.out;
    return;
  }
  const Said checked = mauvectl(socket, {"--json", "check-trace", file}, errors);
  if (checked.exit == 0 || only_late(checked.out)) return;
  const auto kept = std::filesystem::path(testing::TempDir()) / "disobedient.mtrace";
  std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing);
  ADD_FAILURE() << "the trace of this test's mauved, kept in " << kept << ":\n" << checked.out;
}

}  // namespace mauve::test
