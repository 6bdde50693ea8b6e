// SPDX-License-Identifier: LGPL-3.0-or-later
/// What the threads of a mauved told until its test ended obeys the model: `mauvectl check-trace`.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/process.h"

namespace mauve::test {

/// One that hangs, or records nothing, is not asked.
inline void expect_trace_obeys_the_model(const std::string& socket, Process& daemon,
                                         const std::filesystem::path& place) {
  const std::string file = (place / "end.mtrace").string();
  const std::vector<std::string> ctl{MAUVE_BIN_DIR "/mauvectl", "--socket", socket, "--timeout",
                                     "2s"};
  const auto run = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = ctl;
    all.insert(all.end(), words.begin(), words.end());
    Process client(all, (place / "end.txt").string());
    const std::string said = client.all_output();
    return std::pair(client.wait(), said);
  };
  if (!daemon.running() || run({"trace", "dump", "-o", file}).first != 0) return;
  const auto [exit, said] = run({"check-trace", file});
  if (exit == 0) return;
  const auto kept = std::filesystem::path(testing::TempDir()) / "disobedient.mtrace";
  std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing);
  ADD_FAILURE() << "the trace of this test's mauved, kept in " << kept << ":\n" << said;
}

}  // namespace mauve::test
