// SPDX-License-Identifier: LGPL-3.0-or-later
/// Damage keeps nothing from starting: MAUVE_DAMAGED_STATES (8) copies of a state directory are
/// damaged at random, as MAUVE_SEED decides, and mauved is started on each.
#include <sys/stat.h>

#include <cstdio>
#include <map>

#include "kept_daemon.h"
#include "state_damage.h"
#include "support/number_in.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// A generation of the sound directory.
struct Sound {
  std::string file;  ///< byte by byte
  Json content;
  bool confirmed = false;
};

class DamagedStates : public Generations {
 protected:
  static constexpr std::uint64_t kNewest = 7;

  /// Some generations, two of them unconfirmed, a core in quarantine, a flight recording.
  void make_sound(TrialDaemon& daemon) {
    in_the_file_ = exported(daemon);
    ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
    const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}};
    ASSERT_EQ(daemon.ask("core.swap", swap)["saved"], true);
    ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "rolled_back"; }));
    for (const double gain : {3.0, 4.0, 5.0}) {
      const Json both = {{"first.core.gain", gain}, {"second.core.gain", gain}};
      ASSERT_EQ(daemon.ask("param.set", {{"values", both}, {"probation", "off"}})["saved"], true);
    }
    const Json late = {{"values", {{"first.core.gain", 6.0}}}, {"confirm_within", "600s"}};
    ASSERT_EQ(daemon.ask("param.set", late)["generation"], kNewest);
    ASSERT_TRUE(eventually([&] { return !daemon.ask("trace.list")["items"].empty(); }));
    crash(daemon);
    for (std::uint64_t number = 1; number <= kNewest; ++number) {
      const auto text = TempDir::read(file(std::to_string(number)));
      const auto line = text.find('\n');
      sound_[number] = {text, Json::parse(text.substr(line), nullptr, false),
                        text.substr(0, line).find(R"("mark":"confirmed")") != std::string::npos};
    }
    std::filesystem::copy(state(), place_ / "sound", std::filesystem::copy_options::recursive);
  }

  void copy_sound() const {
    std::filesystem::remove_all(state());
    std::filesystem::copy(place_ / "sound", state(), std::filesystem::copy_options::recursive);
  }

  /// It is there as it was, and nobody else may have written it.
  [[nodiscard]] bool intact(std::uint64_t number) const {
    const auto name = file(std::to_string(number));
    struct stat status {};
    return lstat(name.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
           status.st_uid == geteuid() && (status.st_mode & 0022U) == 0 &&
           TempDir::read(name) == sound_.at(number).file;
  }
  /// The newest confirmed generation that is whole; 0: the file.
  [[nodiscard]] std::uint64_t wanted() const {
    const auto folder = std::filesystem::symlink_status(state() / "generations");
    if (!std::filesystem::is_directory(folder)) return 0;
    for (auto it = sound_.rbegin(); it != sound_.rend(); ++it) {
      if (it->second.confirmed && intact(it->first)) return it->first;
    }
    return 0;
  }

  /// Starts it on the damaged directory.
  void expect_start(TrialDaemon& daemon, const std::string& damage) {
    const auto number = wanted();
    std::vector<std::uint64_t> damaged;
    std::error_code failed;
    for (const auto& [one, sound] : sound_) {
      const auto status = std::filesystem::symlink_status(file(std::to_string(one)), failed);
      const bool there = !failed && std::filesystem::exists(status);
      if (there && one > number && !intact(one)) damaged.push_back(one);
    }
    const auto said = daemon.errors().size();
    daemon.start();
    ASSERT_TRUE(daemon.client().connected()) << damage << daemon.errors().substr(said);
    const auto errors = daemon.errors().substr(said);
    EXPECT_EQ(exported(daemon), number == 0 ? in_the_file_ : sound_.at(number).content)
        << damage << ": not generation " << number << "\n"
        << errors;
    for (const auto one : damaged) {
      EXPECT_THAT(errors, HasSubstr("generation " + std::to_string(one) + " cannot be started"))
          << damage;
    }
  }
  /// Every reader of the directory answers.
  static void expect_it_serves(TrialDaemon& daemon, const std::string& damage) {
    for (const auto* method : {"config.history", "quarantine.list", "trace.list", "status.get"}) {
      EXPECT_FALSE(daemon.ask(method).contains("code")) << method << damage;
    }
    const auto recordings = daemon.ask("trace.list");
    for (const auto& one : recordings["items"]) {
      static_cast<void>(daemon.ask("trace.read", {{"recording", one.value("name", "")}}));
    }
    EXPECT_TRUE(daemon.process().running()) << damage << daemon.errors();
  }
  /// The next answers tell the truth: after a crash, mauved runs the architecture that an answer
  /// called saved.
  void expect_honesty(TrialDaemon& daemon, const std::string& damage) {
    const Json released = daemon.ask("quarantine.release", {{"core", "trial/throwing_job"}});
    const bool free = released.value("saved", false);
    freed_ += free ? 1 : 0;
    const auto before = exported(daemon);
    const auto set = daemon.ask("param.set", gain(8.0));
    ASSERT_TRUE(set.contains("saved")) << set << damage;
    const auto changed = exported(daemon);
    EXPECT_EQ(daemon.ask("status.get")["saved"], set["saved"]) << damage;
    saved_ += set["saved"] == true ? 1 : 0;
    const auto said = daemon.errors().size();
    crash(daemon);
    daemon.start();
    ASSERT_TRUE(daemon.client().connected()) << damage << daemon.errors().substr(said);
    const auto now = exported(daemon);
    const bool was_saved = set["saved"] == true;  // else it may be in part
    EXPECT_TRUE(now == changed || (!was_saved && now == before))
        << now << damage << daemon.errors().substr(said);
    EXPECT_TRUE(!free || daemon.ask("quarantine.list")["cores"].empty()) << damage;
    daemon.process().signal(SIGTERM);
    EXPECT_EQ(daemon.process().wait(), 0) << damage << daemon.errors().substr(said);
  }

  const std::uint64_t seed_ = number_in("MAUVE_SEED", 1);
  std::map<std::uint64_t, Sound> sound_;
  Json in_the_file_;
  int saved_ = 0;
  int freed_ = 0;
};

TEST_F(DamagedStates, AreStartedWithTheNewestGenerationThatIsWhole) {
  constexpr std::uint64_t kShortForm = 8;
  const auto count = number_in("MAUVE_DAMAGED_STATES", kShortForm);
  std::printf("seed %lu, %lu directories\n", seed_, count);
  TrialDaemon daemon(kTrial, options());
  make_sound(daemon);
  ASSERT_FALSE(HasFailure()) << daemon.errors();
  std::filesystem::create_directories(place_ / "elsewhere");
  StateDamage damage(state(), place_ / "elsewhere", seed_);
  std::mt19937_64 random(seed_);
  for (std::uint64_t i = 1; i <= count && !HasFailure(); ++i) {
    copy_sound();
    std::string done = "seed " + std::to_string(seed_) + ", directory " + std::to_string(i) + ": ";
    for (auto left = 1 + random() % 3; left > 0; --left) done += damage.next() + "; ";
    expect_start(daemon, done);
    if (!HasFailure()) expect_it_serves(daemon, done);
    if (!HasFailure()) expect_honesty(daemon, done);
    daemon.process().signal(SIGKILL);
    static_cast<void>(daemon.process().wait());
    if (i % 20 == 0) std::printf("%lu directories\n", i);
    std::fflush(stdout);
  }
  std::printf("the next change was saved in %d of %lu, the release of a core in %d\n", saved_,
              count, freed_);
  if (count < kShortForm || HasFailure()) return;  // of a few, all may be too damaged
  EXPECT_GT(saved_, 0);
  EXPECT_GT(freed_, 0);
}

}  // namespace
}  // namespace mauve::test
