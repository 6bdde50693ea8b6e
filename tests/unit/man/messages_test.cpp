// SPDX-License-Identifier: LGPL-3.0-or-later
// An operator can follow the advice of every message: the commands and options that it names exist.
#include <algorithm>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "cli/command.h"
#include "cli/options.h"
#include "daemon/options.h"
#include "support/temp_dir.h"

namespace mauve::man {
namespace {

/// The first group of each match in the page of all messages.
std::set<std::string> named(const char* pattern) {
  const std::string page = test::TempDir::read("docs/messages.md");
  const std::regex form(pattern);
  std::set<std::string> all;
  for (std::sregex_iterator at(page.begin(), page.end(), form), end; at != end; ++at) {
    all.insert((*at)[1]);
  }
  return all;
}

TEST(Messages, NameCommandsThatExist) {
  // Words of sentences about mauvectl itself.
  const std::set<std::string> prose = {"by",       "can", "does",    "has", "is",
                                       "listened", "met", "repeats", "that"};
  const auto words = named("mauvectl ([a-z-]+)");

  EXPECT_GT(words.size(), 20U);
  for (const std::string& word : words) {
    EXPECT_TRUE(prose.contains(word) || ctl::find_command(word) != nullptr) << word;
  }
}

TEST(Messages, NameOptionsThatExist) {
  std::set<std::string> known = {"--install"};  // of cmake
  const auto add = [&](std::string_view name) {
    known.emplace(name.substr(std::min(name.find("--"), name.size())));
  };
  for (const auto& option : daemon::option_texts()) add(option.name);
  for (const auto& option : ctl::global_options()) add(option.name);
  for (const auto& command : ctl::commands()) {
    for (const auto& argument : command.arguments) add(argument.name);
  }
  const auto options = named("[^-a-z](--[a-z][a-z-]*)");

  EXPECT_GT(options.size(), 20U);
  for (const std::string& option : options) EXPECT_TRUE(known.contains(option)) << option;
}

}  // namespace
}  // namespace mauve::man
