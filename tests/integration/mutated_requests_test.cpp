// SPDX-License-Identifier: LGPL-3.0-or-later
/// MAUVE_REQUESTS (3000) requests of all methods, most of them wrong, from 24 clients of three
/// roles, while others change and stop: mauved serves on, nothing is left of the clients, no
/// component loses a release by them, what runs can be started, and what a user stopped stands.
#include <grp.h>
#include <sys/syscall.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <thread>

#include "changeable_systems.h"
#include "look_oracle.h"
#include "mtrace/file.h"
#include "request_mutator.h"
#include "rt/thread/thread.h"
#include "support/crowd.h"
#include "support/foreign_realtime.h"
#include "support/lost_releases.h"
#include "support/number_in.h"
#include "support/process_usage.h"
#include "support/sanitized.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kOfOneRole = 8;
constexpr std::uint64_t kProgress = 100'000;
constexpr const char* kGroups = "mauve-view:x:60001:\nmauve:x:60002:\nmauve-admin:x:60003:\n";

/// The system of the change campaign without the component that hangs.
Json sound_file() {
  Json file = trial_system().file;
  file["components"].erase("weak");
  file["resources"].erase("meter");
  return file;
}

std::map<std::string, std::vector<Json>> sensible_values() {
  Json other = sound_file();
  other["components"]["b"]["properties"]["core.gain"] = 3.0;
  other["components"]["guest"] = trial_system().guests["guest"];
  const std::vector<Json> components{"a", "b", "c", "d"};
  // Sanitizers do not leave a crash to mauved.
  const Json crashes = support::kSanitized ? "trial/throwing_hook" : "trial/crashing_hook";
  return {{"component", components},
          {"components", {{"a"}, {"b", "c"}, {"d"}}},
          {"core",
           {"trial/steady", "trial/other", "trial/counting", "trial/refusing",
            "trial/throwing_hook", crashes, "trial/forgetful"}},
          {"address", {"a", "a.core.gain", "signal.read", "a.ports.output", "b.core.count"}},
          {"addresses", {{"signal.read", "a.core.count"}, {"level.read"}}},
          {"port", {"b.ports.input", "c.ports.input", "a.ports.input"}},
          {"service", {"signal.read", "level.read"}},
          {"plugin", {"trial"}},
          {"values", {{{"a.core.gain", 2.0}}, {{"b.core.gain", 3}, {"c.shell.size", 8}}}},
          {"set", {{{"gain", 2.0}}}},
          {"text", {sound_file().dump(), other.dump(), "{", ""}},
          {"generation", {1, 2, 3, 10, 1000}},
          {"lock", {"none", "params", "all"}},
          {"level", {"info", "warning", "default"}},
          {"probation", {"off", "10", "100"}},
          {"confirm_within", {"50ms", "200ms"}},
          {"state", {"drop"}},
          {"sync", {"cut", "barrier"}},
          {"sub", {1, 2, 3}},
          {"n", {1, 10, 1000}},
          {"rule", {"loud", "quiet"}}};
}

/// Only this thread becomes a member of that group, and another user.
bool become(gid_t group, uid_t user) {
  return syscall(SYS_setgroups, 1, &group) == 0 && syscall(SYS_setresuid, -1, user, -1) == 0;
}

/// The data that all clients share.
struct Flood {
  std::filesystem::path socket;
  std::uint64_t seed = 1;
  std::atomic<std::int64_t> left{0};
  std::int64_t blind = 0;  ///< so many of the last may end the trace, which is the witness
  std::atomic<std::uint64_t> sent{0};
  std::atomic<std::uint64_t> answers{0};
  std::atomic<std::uint64_t> closed{0};
  std::atomic<std::uint64_t> late{0};  ///< rounds in which nothing came for kPatience, but then did
  std::atomic<std::uint64_t> silent{0};
};

/// Sends some lines and then a ping, and reads until that is answered.
class HostileClient {
 public:
  HostileClient(Flood& flood, std::uint64_t seed)
      : flood_(flood), mutator_(sensible_values(), seed) {}

  void send_some() {
    constexpr int kLines = 4;
    if (client_ == nullptr) client_ = std::make_unique<RawClient>(flood_.socket);
    if (!client_->connected()) ++flood_.silent;
    std::string lines;
    for (int i = 0; i < kLines; ++i) lines += next() + '\n';
    const std::string last = "last " + std::to_string(++pings_);
    lines += protocol::to_line(protocol::make_request(last, "ping", Json::object())) + '\n';
    if (const auto sent = flood_.sent += kLines; sent % kProgress == 0) {
      std::printf("%lu lines\n", sent);
      std::fflush(stdout);
    }
    if (!client_->send(lines) || !read_to(last, lines)) client_.reset();
  }

 private:
  std::string next() {
    for (;;) {
      auto line = mutator_.next();
      // No request names the component that a user has stopped, but all are meant by some.
      const bool starts_all = line.find("component.start") != std::string::npos &&
                              line.find("\"all\"") != std::string::npos;
      if (starts_all) continue;
      const bool ends_the_trace = line.find("trace.st") != std::string::npos;
      if (!ends_the_trace || flood_.left <= flood_.blind) return line;
    }
  }
  /// On a slow machine a ping waits for requests before it, which are served in turn. An answer
  /// that is late is distinguished from one that never comes.
  bool read_to(const std::string& last, const std::string& lines) {
    const auto begin = steady_clock::now();
    bool late = false;
    while (steady_clock::now() - begin < kNever) {
      const auto line = client_->line();
      if (!line && client_->ended()) {
        ++flood_.closed;
        return false;
      }
      late = late || !line;
      if (!line || (!line->starts_with("{\"id\"") && line->find("\"id\":") == std::string::npos)) {
        continue;
      }
      ++flood_.answers;
      if (line->find("\"" + last + "\"") == std::string::npos) continue;
      flood_.late += late ? 1 : 0;
      return true;
    }
    ++flood_.silent;
    std::printf("no answer within five minutes to\n%s", lines.c_str());
    return false;
  }
  static constexpr std::chrono::minutes kNever{5};

  Flood& flood_;
  RequestMutator mutator_;
  std::unique_ptr<RawClient> client_;
  std::uint64_t pings_ = 0;
};

/// Eight clients of one user take turns. `role`: of the three groups; negative: as this user.
void flood_as(int role, Flood& flood) {
  const auto number = static_cast<std::uint64_t>(role + 1);
  if (role >= 0 && !become(60'001 + static_cast<gid_t>(role), 50'001 + static_cast<uid_t>(role))) {
    ++flood.silent;
    return;
  }
  std::deque<HostileClient> clients;
  const std::size_t count = role >= 0 ? kOfOneRole : kOfOneRole / 2;
  for (std::size_t i = 0; i < count; ++i)
    clients.emplace_back(flood, flood.seed + 100 * number + i);
  for (std::size_t i = 0; flood.left.fetch_sub(4) > 0; ++i) clients[i % count].send_some();
}

/// Changes what runs all the time; the changes that were applied.
int change_on(RawClient client, const std::atomic<bool>& end) {
  const std::string file = sound_file().dump();
  const std::vector<std::pair<std::string, Json>> changes = {
      {"lock.set", {{"lock", "none"}}},
      {"component.start", {{"components", {"a", "b", "c", "d"}}}},
      {"param.set", {{"values", {{"a.core.gain", 2.0}}}}},
      {"core.swap", {{"component", "b"}, {"core", "trial/other"}, {"probation", "off"}}},
      {"plugin.reload", {{"plugin", "trial"}}},
      {"config.rollback", {{"generation", 2}, {"state", "drop"}}},
      {"architecture.apply", {{"text", file}, {"state", "drop"}}}};
  int applied = 0;
  for (std::size_t i = 0; !end; ++i) {
    const auto& [method, params] = changes[i % changes.size()];
    const auto answer = client.ask(method, params);
    if (answer.is_null()) return applied;
    if (answer.contains("result")) ++applied;
    static_cast<void>(client.ask("component.start", {{"components", {"a", "b", "c"}}}));
  }
  return applied;
}

struct Stops {
  int others = 0;  ///< without an answer, or refused
  std::vector<std::chrono::microseconds> took;
  Json refusal;

  /// In milliseconds; `part` of them took at most so long.
  [[nodiscard]] double time(double part) {
    if (took.empty()) return 0;
    std::sort(took.begin(), took.end());
    const auto last = static_cast<double>(took.size() - 1);
    return std::chrono::duration<double, std::milli>(took[static_cast<std::size_t>(part * last)])
        .count();
  }
};

/// A stop is served whatever else happens.
Stops stop_on(RawClient client, const std::atomic<bool>& end) {
  Stops stops;
  while (!end) {
    const auto begin = steady_clock::now();
    const auto answer = client.ask("component.stop", {{"components", {"d"}}});
    const auto time = std::chrono::ceil<std::chrono::microseconds>(steady_clock::now() - begin);
    const bool good = answer.is_object() && answer.contains("result");
    if (good) {
      stops.took.push_back(time);
    } else {
      ++stops.others;
      stops.refusal = answer;
    }
    if (answer.is_null()) return stops;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    static_cast<void>(client.ask("component.start", {{"components", {"d"}}}));
  }
  return stops;
}

class MutatedRequests : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> options() const {
    return {"--realtime",  realtime_ ? "require" : "off", "--admission", "strict",
            "--state-dir", (place_ / "state").string()};
  }
  /// Everything that is made once is there, and then counted. A change of a client that has left
  /// may still be under way, or wait to be confirmed.
  void settle(TrialDaemon& daemon) {
    const auto file = sound_file().dump();
    static_cast<void>(daemon.ask("lock.set", {{"lock", "none"}}));
    static_cast<void>(daemon.ask("config.check", {{"text", file}}));
    Json applied;
    EXPECT_TRUE(eventually([&] {
      static_cast<void>(daemon.ask("change.confirm"));
      static_cast<void>(daemon.ask("plugin.reload", {{"plugin", "trial"}}));
      applied = daemon.ask("architecture.apply",
                           {{"text", file}, {"state", "drop"}, {"probation", "off"}});
      return applied.value("generation", 0) > 0;
    })) << applied
        << daemon.errors();
    static_cast<void>(daemon.ask("component.start", {{"components", {"a", "b", "c", "d"}}}));
    if (!realtime_) return;
    EXPECT_EQ(daemon.ask("trace.start", {{"seconds", 12}})["on"], true);
  }
  /// Reads the trace until the requests are sent.
  void witness(TrialDaemon& daemon, const std::atomic<bool>& end) {
    LossWitness releases;
    const auto file = (place_ / "slice.mtrace").string();
    for (bool last = false; !last;) {
      last = end;
      if (last) std::this_thread::sleep_for(std::chrono::seconds(1));  // newer is not looked at
      std::string foreign;
      for (int i = 0; i < 20 && !end; ++i) {
        if (foreign.empty()) foreign = foreign_realtime(daemon.process().id());
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
      }
      if (daemon.ask("trace.status")["on"] != true) {  // a damaged request met trace.stop
        static_cast<void>(daemon.ask("trace.start", {{"seconds", 12}}));
        continue;
      }
      if (daemon.ctl({"trace", "dump", "-o", file}).exit != 0) continue;
      const auto slice = ctl::mtrace::read_file(file);
      if (!slice) continue;
      for (const auto& lost : releases.look(*slice)) {
        if (lost.disturbed || !foreign.empty()) {
          set_apart_ += lost.count;
          continue;
        }
        const auto kept = testing::TempDir() + "lost-beside-requests.mtrace";
        std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing);
        ADD_FAILURE() << lost.component << " lost " << lost.count << " releases at " << lost.time
                      << " ns; the trace: " << kept;
      }
    }
    std::printf(
        "%lu releases, %ld lost while the machine stood still or beside other real-time "
        "programs, %d gaps\n",
        releases.releases(), set_apart_, releases.gaps());
    EXPECT_GT(releases.releases(), 0U);
  }
  /// Sends them all, beside those who change, stop and look.
  void send_all(TrialDaemon& daemon, Flood& flood, bool roles) {
    std::atomic<bool> end{false};
    int applied = 0;
    Stops stops;
    const auto stop = daemon.ask("component.stop", {{"components", {"stood"}}});
    ASSERT_EQ(stop["saved"], true) << stop;
    LookOracle oracle(daemon, "stood");
    std::vector<std::thread> beside;
    beside.emplace_back([&, client = std::make_shared<RawClient>(daemon.client())] {
      applied = change_on(std::move(*client), end);
    });
    beside.emplace_back([&, client = std::make_shared<RawClient>(daemon.client())] {
      stops = stop_on(std::move(*client), end);
    });
    if (realtime_) beside.emplace_back([&] { witness(daemon, end); });
    std::vector<std::thread> hostile;
    for (const int role : roles ? std::vector<int>{0, 1, 2} : std::vector<int>{-1}) {
      hostile.emplace_back([&flood, role] { flood_as(role, flood); });
    }
    for (auto& thread : hostile) thread.join();
    end = true;
    for (auto& thread : beside) thread.join();
    oracle.finish();

    std::printf(
        "%lu lines sent, %lu answers, %lu rounds of them late, %lu connections closed; %d changes; "
        "%zu stops in %.1f ms, 99 %% in %.1f ms, all in %.1f ms\n",
        flood.sent.load(), flood.answers.load(), flood.late.load(), flood.closed.load(), applied,
        stops.took.size(), stops.time(0.5), stops.time(0.99), stops.time(1));
    EXPECT_EQ(flood.silent, 0U) << "clients without an answer, or without their role";
    EXPECT_GT(flood.answers, flood.sent / 4) << "more are answered than the pings";
    EXPECT_GT(applied, 0);
    EXPECT_FALSE(stops.took.empty());
    EXPECT_EQ(stops.others, 0) << stops.refusal;
  }

  const TempDir place_;
  const bool realtime_ = !support::kSanitized && rt::may_use_fifo(99).has_value();
  std::int64_t set_apart_ = 0;
};

TEST_F(MutatedRequests, LeaveNothingBehindAndCostNoRelease) {
  const bool roles = Crowd::possible();
  if (!roles) std::printf("SKIPPED viewers and operators: %s\n", Crowd::kNotPossible);
  const std::string program = MAUVE_BIN_DIR "/mauved";
  TrialDaemon daemon(sound_file().dump(), options(),
                     roles ? Crowd(place_.path(), program, kGroups).program() : program);
  settle(daemon);
  settle(daemon);
  using std::filesystem::perms;
  std::filesystem::permissions(daemon.socket().parent_path(), static_cast<perms>(0711));
  std::filesystem::permissions(daemon.socket(), static_cast<perms>(0666));
  const pid_t process = daemon.process().id();
  const auto descriptors = entries(process, "fd");
  ASSERT_GT(descriptors, 0U);
  const auto threads = entries(process, "task");
  Flood flood;
  flood.socket = daemon.socket();
  flood.seed = number_in("MAUVE_SEED", 1);
  flood.left = static_cast<std::int64_t>(number_in("MAUVE_REQUESTS", 3000));
  flood.blind = flood.left / 10;
  std::printf("seed %lu\n", flood.seed);

  send_all(daemon, flood, roles);

  ASSERT_TRUE(daemon.process().running()) << daemon.errors();
  settle(daemon);
  EXPECT_TRUE(eventually([&] { return entries(process, "fd") <= descriptors; }))
      << entries(process, "fd") << " descriptors, before " << descriptors;
  EXPECT_TRUE(eventually([&] { return entries(process, "task") <= threads; }))
      << entries(process, "task") << " threads, before " << threads;
  Json status;
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(daemon.ask("component.start", {{"all", true}}));
    status = daemon.ask("status.get");
    const Json& rows = status["components"];
    return rows.size() == sound_file()["components"].size() &&
           std::ranges::all_of(rows, [](const Json& row) { return row["state"] == "running"; });
  })) << status;
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.errors();
  if (!realtime_ && !support::kSanitized && !HasFailure()) {
    GTEST_SKIP() << "SKIPPED the releases: no SCHED_FIFO here, so nothing looked at them";
  }
}

}  // namespace
}  // namespace mauve::test
