// SPDX-License-Identifier: LGPL-3.0-or-later
// Comparing the sample architecture with others, and differences in words.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "arch/build/load.h"
#include "arch/compare/diff.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "unit/arch/architecture_text.h"
#include "unit/arch/sample_plugin.h"

namespace mauve::arch {

inline std::string said(const Line& line) {
  const std::string subject = line.kind + " " + line.address;
  switch (line.op) {
    case Line::Op::add:
      return "+ " + subject + ": " + to_string(line.after);
    case Line::Op::remove:
      return "- " + subject + ": " + to_string(line.before);
    case Line::Op::change:
      break;
  }
  return "~ " + subject + ": " + to_string(line.before) + " -> " + to_string(line.after);
}

inline std::vector<std::string> said(const std::vector<Line>& lines) {
  std::vector<std::string> texts;
  for (const Line& line : lines) texts.push_back(said(line));
  return texts;
}

inline std::vector<std::string> said(const std::vector<NewConnection>& connections) {
  std::vector<std::string> texts;
  for (const NewConnection& one : connections) {
    texts.push_back(one.port + "=" + one.service + "/" + std::to_string(one.max_age.count()));
  }
  return texts;
}

inline std::vector<std::string> said(const std::vector<std::pair<std::string, Value>>& properties) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : properties) texts.push_back(name + "=" + to_string(value));
  return texts;
}

inline bool empty(const Change& change) {
  return change.edits.empty() && change.new_resources.empty() && change.new_components.empty() &&
         change.remove.empty() && !change.probation;
}

class Diff : public testing::Test {
 protected:
  Diff() { EXPECT_TRUE(catalog_.add(sample::make_plugin())); }

  std::unique_ptr<Architecture> made(std::string_view text) {
    Problems problems;
    auto architecture = load(text, catalog_, problems);
    for (const Problem& problem : problems.sorted()) ADD_FAILURE() << to_string(problem, "text");
    return architecture;
  }
  /// From the sample to this text.
  Difference to(std::string_view text, const Parked& parked = {}) {
    running_ = made(sample::kArchitecture);
    wanted_ = made(text);
    if (running_ == nullptr || wanted_ == nullptr) return {};
    return compare(*running_, *wanted_, parked);
  }
  Difference to_with(std::string_view what, std::string_view by) {
    return to(sample::with(what, by));
  }
  const Edit& only_edit(const Difference& difference) {
    static const Edit kNone{};
    EXPECT_EQ(difference.change.edits.size(), 1U);
    return difference.change.edits.size() == 1 ? difference.change.edits[0] : kNone;
  }

  plugin::Catalog catalog_;
  std::unique_ptr<Architecture> running_;
  std::unique_ptr<Architecture> wanted_;
};

}  // namespace mauve::arch
