// SPDX-License-Identifier: LGPL-3.0-or-later
// Damaged plugin files end no daemon: MAUVE_DAMAGED_FILES of them (100) are loaded, one after
// another.
#include <elf.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <random>
#include <span>

#include "plugin/elf/checksum.h"
#include "rt/thread/run_guarded.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

int number_in(const char* variable, int otherwise) {
  const char* given = std::getenv(variable);
  return given == nullptr ? otherwise : std::atoi(given);
}

/// How many files, MAUVE_CAMPAIGN_SECONDS at most.
class Rounds {
 public:
  [[nodiscard]] bool go_on() {
    return done_ < number_in("MAUVE_DAMAGED_FILES", 100) &&
           std::chrono::steady_clock::now() < end_ && ++done_ > 0;
  }
  [[nodiscard]] int done() const { return done_; }

 private:
  const std::chrono::steady_clock::time_point end_ =
      std::chrono::steady_clock::now() +
      std::chrono::seconds(number_in("MAUVE_CAMPAIGN_SECONDS", 3600));
  int done_ = 0;
};

/// A plugin with some bytes changed, preferably in the tables that the dynamic linker trusts.
class Damage {
 public:
  enum class Where : std::uint8_t { anywhere, tables };

  Damage(std::string sound, Where where) : sound_(std::move(sound)) {
    Elf64_Ehdr header;
    std::memcpy(&header, sound_.data(), sizeof header);
    places_ = {{0, sizeof header},
               {header.e_phoff, std::size_t{header.e_phnum} * sizeof(Elf64_Phdr)}};
    if (where == Where::anywhere) places_.emplace_back(0, sound_.size());
    for (std::size_t i = 0; i < header.e_shnum; ++i) {
      Elf64_Shdr section;
      std::memcpy(&section, &sound_[header.e_shoff + i * sizeof section], sizeof section);
      const bool hit = is_table(section.sh_type) ||
                       (where == Where::anywhere && section.sh_type == SHT_PROGBITS);
      if (hit && section.sh_size > 0) places_.emplace_back(section.sh_offset, section.sh_size);
    }
  }

  [[nodiscard]] std::string next() {
    std::string text = sound_;
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
      const auto& [from, size] = places_[below(places_.size())];
      text[from + below(size)] = static_cast<char>(below(256));
    }
    return text;
  }

 private:
  static bool is_table(Elf64_Word type) {
    return type == SHT_DYNAMIC || type == SHT_RELA || type == SHT_DYNSYM || type == SHT_STRTAB ||
           type == SHT_GNU_HASH || type == SHT_GNU_versym || type == SHT_GNU_verneed ||
           type == SHT_INIT_ARRAY || type == SHT_FINI_ARRAY;
  }
  std::size_t below(std::size_t limit) { return random_() % limit; }

  std::mt19937_64 random_{20241122};
  std::string sound_;
  std::vector<std::pair<std::size_t, std::size_t>> places_;
};

/// mauved, and the file good.so in its plugin directory.
class DamagedPlugins : public testing::Test {
 protected:
  void put(const std::string& text) {
    const auto file = files_.write("good.so", text);
    std::filesystem::rename(file, daemon_.plugins() / "good.so");
  }
  /// Loads it, and unloads it again when that works.
  protocol::Json load() {
    auto answer = daemon_.ask("plugin.load", {{"plugin", "good"}});
    if (answer.contains("loaded")) {
      const auto unloaded = daemon_.ask("plugin.unload", {{"plugin", "good"}});
      EXPECT_EQ(unloaded["loaded"], false) << unloaded;
    }
    return answer;
  }
  /// The file before any damage. On a busy machine it may be tried for longer than mauved waits.
  [[nodiscard]] bool sound_one_loads() {
    put(sound());
    return eventually([&] { return load().value("loaded", false); });
  }
  void expect_unharmed() {
    EXPECT_TRUE(daemon_.process().running()) << daemon_.errors();
    EXPECT_EQ(daemon_.component("first")["state"], "running");
  }

  TempDir files_;
  TrialDaemon daemon_{kTrial, {"--realtime", "off", "--prepare-within", "2s"}};
  static std::string sound() {
    return TempDir::read(std::filesystem::path(MAUVE_ZOO) / "1" / "good.so");
  }
  static Damage damage(Damage::Where where) { return {sound(), where}; }
};

TEST_F(DamagedPlugins, AreRefusedBeforeTheDynamicLinkerReadsThem) {
  ASSERT_TRUE(sound_one_loads()) << daemon_.errors();
  int loaded = 0;
  auto damaged = damage(Damage::Where::anywhere);
  Rounds rounds;
  while (rounds.go_on()) {
    put(damaged.next());
    const auto answer = load();
    if (answer.contains("loaded")) ++loaded;  // it hit a byte that nobody maps
    ASSERT_TRUE(daemon_.process().running()) << "file " << rounds.done() << daemon_.errors();
  }
  EXPECT_LT(loaded, rounds.done());
  expect_unharmed();
}

/// As if a user ran mauve-stamp over the damage. The damage spares code: an author vouches for code
/// that is stamped, and such code may behave in mauved as it did not in the trial.
TEST_F(DamagedPlugins, WhoseTablesAreStampedAgainAreRefusedOrTriedElsewhereFirst) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer looks into a damaged plugin by itself";
  ASSERT_TRUE(sound_one_loads()) << daemon_.errors();
  int stamped = 0;
  auto damaged = damage(Damage::Where::tables);
  Rounds rounds;
  while (rounds.go_on()) {
    auto text = damaged.next();
    if (plugin::stamp(std::as_writable_bytes(std::span(text)))) ++stamped;
    put(text);
    static_cast<void>(load());
    ASSERT_TRUE(daemon_.process().running()) << "file " << rounds.done() << daemon_.errors();
  }
  EXPECT_GT(stamped, 0);
  expect_unharmed();
}

}  // namespace
/// A reload would not renew the code of such a library, and a write into its file would end mauved.
TEST(HelperLibraries, ThatAreNotOfTheSystemAreRefused) {
  const TempDir place;
  const auto file = place.write("helped.json", R"({"schema": "mauve/architecture/1",
    "name": "helped", "plugins": ["needs_helper"]})");
  const auto check = [&](const std::string& path) {
    setenv("LD_LIBRARY_PATH", path.c_str(), 1);
    const auto errors = place / "errors";
    Process mauved({MAUVE_BIN_DIR "/mauved", "--check", file.string(), "--plugin-dir", MAUVE_ZOO},
                   errors);
    EXPECT_NE(mauved.wait(), 0);
    unsetenv("LD_LIBRARY_PATH");
    return TempDir::read(errors);
  };
  const std::string folder = std::string(MAUVE_ZOO) + "/helper";

  EXPECT_THAT(check(folder), testing::HasSubstr("needs " + folder +
                                                "/libzoo_helper.so, which is "
                                                "not a library of the system"));
  EXPECT_THAT(check("/nowhere"), testing::HasSubstr("cannot be linked: libzoo_helper.so"));
}

}  // namespace mauve::test
