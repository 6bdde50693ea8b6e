// SPDX-License-Identifier: LGPL-3.0-or-later
// The built pages hold every row of every table, and groff reads them without a warning.
#include "pages.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/command.h"
#include "cli/options.h"
#include "daemon/options.h"
#include "protocol/methods_text.h"
#include "protocol/openrpc.h"
#include "roff.h"
#include "support/temp_dir.h"

namespace mauve::man {
namespace {

using protocol::Json;
using testing::HasSubstr;

std::string page_of(const std::string& name) {
  const std::string file = MAUVE_MAN_DIR "/man" + name.substr(name.size() - 1) + "/" + name;
  std::string text = test::TempDir::read(file);
  EXPECT_FALSE(text.empty()) << file;
  return text;
}

const std::vector<std::string> kPages = {
    "mauved.8",      "mauve-guardian.8",     "mauvectl.1",
    "mauve-stamp.1", "mauve-architecture.5", "mauve-protocol.7"};

/// All that a command of the shell prints, and its status.
std::pair<std::string, int> output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {"cannot be run", -1};
  char piece[4096];
  for (std::size_t size = 0; (size = fread(piece, 1, sizeof piece, pipe)) > 0;) {
    text.append(piece, size);
  }
  const int status = pclose(pipe);
  return {text, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

bool is_installed(const std::string& program) {
  return output_of("command -v " + program).second == 0;
}

TEST(ManPages, NameEveryCommandAndItsArguments) {
  const std::string page = page_of("mauvectl.1");
  for (const auto& command : ctl::commands()) {
    EXPECT_THAT(page, HasSubstr(".SS " + bold(command.name)));
    EXPECT_THAT(page, HasSubstr(plain(command.text)));
    EXPECT_THAT(page, HasSubstr(bold(command.example)));
    for (const auto& argument : command.arguments) {
      EXPECT_THAT(page, HasSubstr(plain(argument.text))) << command.name << argument.name;
    }
  }
}

TEST(ManPages, NameEveryOptionAndExitCodeOfTheClient) {
  const std::string page = page_of("mauvectl.1");
  for (const auto& option : ctl::global_options()) {
    EXPECT_THAT(page, HasSubstr(".TP\n" + bold(option.name)));
  }
  ASSERT_EQ(ctl::exit_codes().size(), 10U);
  for (const auto& code : ctl::exit_codes()) {
    EXPECT_THAT(page,
                HasSubstr(".TP\n" + bold(std::to_string(code.code)) + "\n" + plain(code.text)));
  }
}

TEST(ManPages, NameEveryOptionOfTheDaemon) {
  const std::string page = page_of("mauved.8");
  const auto options = daemon::option_texts();
  ASSERT_GT(options.size(), 8U);
  std::set<std::string> names;
  for (const auto& option : options) {
    names.insert(option.name);
    EXPECT_FALSE(option.text.empty()) << option.name;
    if (option.name.starts_with('-')) {
      EXPECT_THAT(page, HasSubstr(".TP\n" + bold(option.name)));
    }
    EXPECT_THAT(page, HasSubstr(plain(option.text)));
    EXPECT_THAT(page, HasSubstr(plain(option.value)));
  }
  EXPECT_TRUE(names.contains("--plugin-dir"));
  EXPECT_TRUE(names.contains("architecture"));
}

TEST(ManPages, NameEveryOptionThatTheGuardianPrints) {
  const std::string page = page_of("mauve-guardian.8");
  const auto [help, status] = output_of(MAUVE_BIN_DIR "/mauve-guardian --help");
  EXPECT_EQ(status, 0);
  std::istringstream stream(help);
  std::set<std::string> options;
  for (std::string word; stream >> word;) {
    if (word.starts_with("--")) options.insert(word);
  }
  EXPECT_THAT(options, testing::IsSupersetOf({"--socket", "--connected"}));
  for (const auto& option : options) EXPECT_THAT(page, HasSubstr(plain(option))) << help;
}

/// The text below a heading, up to the next one.
std::string below(const std::string& page, const std::string& heading) {
  const auto begin = page.find("\n.SS " + plain(heading) + "\n");
  EXPECT_NE(begin, std::string::npos) << heading;
  return begin == std::string::npos ? ""
                                    : page.substr(begin + 1, page.find("\n.S", begin + 1) - begin);
}

TEST(ManPages, DescribeEveryMethodByItsRow) {
  const std::string page = page_of("mauve-protocol.7");
  for (const auto& method : protocol::methods()) {
    const std::string its = below(page, std::string(method.name));
    EXPECT_THAT(its, HasSubstr(plain(method.help))) << method.name;
    EXPECT_THAT(its, HasSubstr(bold(to_string(method.role)))) << method.name;
    for (const auto fields : {method.params, method.answer}) {
      for (const auto& field : fields) {
        EXPECT_THAT(its, HasSubstr(".TP\n" + bold(field.name) + "\n" +
                                   plain(protocol::in_words(field.type))))
            << method.name;
        EXPECT_THAT(its, HasSubstr(inline_roff(protocol::sentence_of(field)))) << method.name;
      }
    }
  }
}

TEST(ManPages, DescribeEveryRecordOfAnswers) {
  const std::string page = page_of("mauve-protocol.7");
  const auto records = protocol::records_in(protocol::methods());
  ASSERT_GT(records.size(), 30U);
  for (const auto* record : records) {
    const std::string its = below(page, std::string(record->name));
    for (const auto& field : record->fields)
      EXPECT_THAT(its, HasSubstr(".TP\n" + bold(field.name)));
  }
}

TEST(MethodsPage, IsMadeFromTheTable) {
  const std::string page = test::TempDir::read(MAUVE_MAN_DIR "/../doc/mauve/methods.md");
  EXPECT_THAT(page, HasSubstr("\n" + protocol::methods_in_markdown()));
}

TEST(ManPages, NameEveryEventOfTheProtocol) {
  const std::string events =
      section(test::TempDir::read("daemon/protocol/README.md"), "Notifications");
  const std::string page = page_of("mauve-protocol.7");
  const std::string mark = "\"method\":\"";
  std::size_t count = 0;
  for (auto at = events.find(mark); at != std::string::npos; at = events.find(mark, at + 1)) {
    const auto name = events.substr(at, events.find(',', at) - at);
    EXPECT_THAT(page, HasSubstr(plain(name)));
    ++count;
  }
  EXPECT_GE(count, 3U);
}

/// Collects the names below every "properties" of a schema.
void collect_keys(const Json& schema, std::set<std::string>& keys) {
  if (!schema.is_structured()) return;
  for (const auto& [name, part] : schema.items()) {
    // A key may itself be called "properties"; what stands below that are words of the schema.
    const bool all_schemas =
        std::all_of(part.begin(), part.end(), [](const Json& its) { return its.is_object(); });
    if (schema.is_object() && name == "properties" && all_schemas) {
      for (const auto& [key, its] : part.items()) keys.insert(key);
    }
    collect_keys(part, keys);
  }
}

TEST(ManPages, NameEveryKeyOfTheSchema) {
  const std::string page = page_of("mauve-architecture.5");
  std::set<std::string> keys;
  collect_keys(Json::parse(test::TempDir::read("etc/architecture.schema.json")), keys);
  ASSERT_GT(keys.size(), 30U);
  for (const std::string& key : keys) EXPECT_THAT(page, HasSubstr(".TP\n" + bold(key) + " ("));
}

TEST(ManPages, GiveExamplesThatTheClientUnderstands) {
  for (const auto& command : ctl::commands()) {
    std::istringstream stream{std::string(command.example)};
    std::vector<std::string> words;
    for (std::string word; stream >> word && word != ">";) words.push_back(word);
    ASSERT_EQ(words.front(), "mauvectl");
    const auto parsed = ctl::parse_options({words.begin() + 1, words.end()});
    const auto* invocation = std::get_if<ctl::Invocation>(&parsed);
    ASSERT_NE(invocation, nullptr) << command.example;
    EXPECT_EQ(invocation->command->name, command.name);
  }
}

TEST(ManPages, AreReadByGroffWithoutAWarning) {
  if (!is_installed("groff")) GTEST_SKIP() << "SKIPPED: groff is not installed (scripts/setup)";
  for (const auto& name : kPages) {
    const std::string file = MAUVE_MAN_DIR "/man" + name.substr(name.size() - 1) + "/" + name;
    for (const char* device : {"utf8", "ascii"}) {
      const auto [text, status] =
          output_of("groff -t -man -ww -z -T" + std::string(device) + " " + file);
      EXPECT_EQ(text, "") << name;
      EXPECT_EQ(status, 0);
    }
  }
}

TEST(ManPages, AreShownByMan) {
  if (!is_installed("man")) GTEST_SKIP() << "SKIPPED: man is not installed (scripts/setup)";
  for (const auto& name : kPages) {
    const std::string file = MAUVE_MAN_DIR "/man" + name.substr(name.size() - 1) + "/" + name;
    const auto [warnings, status] =
        output_of("LC_ALL=C.UTF-8 MANROFFSEQ= man --warnings -E UTF-8 -l " + file + " >/dev/null");
    EXPECT_EQ(warnings, "") << name;
    EXPECT_EQ(status, 0);
    const auto [shown, end] = output_of("LC_ALL=C.UTF-8 MANWIDTH=80 man -l " + file);
    EXPECT_EQ(end, 0);
    EXPECT_THAT(shown, HasSubstr("SEE ALSO")) << name;
    EXPECT_THAT(shown, testing::Not(HasSubstr("\\f"))) << "no roff is left in it";
  }
}

TEST(ManPages, RefuseATemplateThatMeansNothing) {
  EXPECT_FALSE(page("@nonsense\n", "."));
  EXPECT_FALSE(page("@section daemon/README.md No such heading\n", "."));
  EXPECT_FALSE(page("@file no/such.file\n", "."));
  EXPECT_EQ(*page(".SH A\ntext\n", "."), ".SH A\ntext\n");
}

}  // namespace
}  // namespace mauve::man
