// SPDX-License-Identifier: LGPL-3.0-or-later
/// Up to 32 clients at once on a mauved: half of them watch, half of them ask ten times a second.
#include <atomic>
#include <deque>
#include <memory>
#include <string>
#include <thread>

#include <time.h>

#include "bench/scale/sweeps.h"
#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/sweep.h"
#include "support/crowd.h"
#include "support/missed_releases.h"
#include "support/temp_dir.h"

namespace bench::scale {
namespace {

using Json = mauve::protocol::Json;
using mauve::test::Crowd;
using mauve::test::RawClient;

constexpr int kWatched = 4;
constexpr std::int64_t kWatchedPeriod = 1'000'000;

/// Above other people's real-time threads, which a probe above all does not see.
std::string architecture() {
  Json file = {{"schema", "mauve/architecture/1"}, {"name", "clients"}, {"plugins", {"demo"}}};
  for (int i = 0; i < kWatched; ++i) {
    file["components"]["counter" + std::to_string(i)] = {{"type", "demo/counter"},
                                                         {"properties", {{"fsm.period", "1ms"}}},
                                                         {"task", {{"priority", 90}}}};
  }
  return file.dump();
}

/// A mauved, ended with it.
class Daemon {
 public:
  explicit Daemon(bool crowd) : file_(place_.write("clients.json", architecture())) {
    std::string program = MAUVE_BIN_DIR "/mauved";
    if (crowd) program = Crowd(place_.path(), program).program();
    process_ = std::make_unique<mauve::test::Process>(std::vector<std::string>{
        program, file_.string(), "--socket", socket().string(), "--plugin-dir", MAUVE_PLUGIN_DIR});
    up_ = mauve::test::eventually([&] { return ask("ping").contains("pong"); });
  }
  [[nodiscard]] std::filesystem::path socket() const { return place_ / "s"; }
  [[nodiscard]] bool up() const { return up_; }
  /// As root, who has a slot beside all others, but only while asking.
  [[nodiscard]] Json ask(const char* method, Json params = Json::object()) const {
    RawClient root(socket());
    static_cast<void>(root.json());
    const Json answer = root.ask(method, std::move(params));
    return answer.is_object() ? answer.value("result", Json::object()) : Json::object();
  }
  /// ns, of all its threads.
  [[nodiscard]] Instant processor_time() const {
    clockid_t clock{};
    timespec t{};
    if (clock_getcpuclockid(process_->id(), &clock) == 0) clock_gettime(clock, &t);
    return static_cast<Instant>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
  }
  /// By its trace.
  [[nodiscard]] mauve::test::MissedReleases missed(std::int64_t since) const {
    const auto trace = place_ / "end.mtrace";
    mauve::test::Process dump({MAUVE_BIN_DIR "/mauvectl", "--socket", socket().string(), "trace",
                               "dump", "-o", trace.string()});
    static_cast<void>(dump.wait());
    return mauve::test::missed_releases(trace, since, kWatchedPeriod);
  }

 private:
  mauve::test::TempDir place_;
  std::filesystem::path file_;
  std::unique_ptr<mauve::test::Process> process_;
  bool up_ = false;
};

/// Threads that do what clients do, until the end.
class Clients {
 public:
  Clients(const Daemon& daemon, int count) {
    for (int i = 0; i < count; ++i) {
      clients_.push_back(Crowd::client(daemon.socket(), static_cast<std::size_t>(i)));
    }
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      threads_.emplace_back([this, i] { i % 2 == 0 ? watch(clients_[i]) : ask(clients_[i]); });
    }
  }
  ~Clients() {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Clients(const Clients&) = delete;
  Clients& operator=(const Clients&) = delete;
  [[nodiscard]] bool refused() const { return refused_; }
  std::atomic<int> received{0};

 private:
  void watch(RawClient& client) {
    Json addresses = Json::array();
    for (int i = 0; i < kWatched; ++i) {
      addresses.push_back("counter" + std::to_string(i) + ".core.count");
    }
    if (!client.ask("watch.subscribe", {{"addresses", addresses}}).contains("result")) {
      refused_ = true;
    }
    while (!over_ && !refused_) received += client.line(std::chrono::milliseconds(100)) ? 1 : 0;
  }
  void ask(RawClient& client) {
    for (int i = 0; !over_; ++i) {
      const Json answer = client.ask(i % 2 == 0 ? "stats.get" : "status.get");
      if (!answer.contains("result")) {
        refused_ = true;
        return;
      }
      ++received;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }

  std::atomic<bool> over_{false};
  std::atomic<bool> refused_{false};  // one of them
  std::deque<RawClient> clients_;
  std::vector<std::thread> threads_;
};

/// False when this measured nothing.
bool measure(Sweep& sweep, const Daemon& daemon, int count, Duration time) {
  const bool alone = mauve::test::eventually(
      [&] { return daemon.ask("client.list").value("items", Json::array()).size() == 1; });
  if (!alone) return false;
  Clients clients(daemon, count);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  static_cast<void>(daemon.ask("trace.start"));  // with it there are probes
  static_cast<void>(daemon.ask("stats.reset"));
  const std::int64_t since = daemon.ask("stats.get").value("t_ns", std::int64_t{0});
  const Instant begun = now();
  const Instant busy = daemon.processor_time();
  clients.received = 0;
  std::this_thread::sleep_for(time);
  const Json found = daemon.ask("stats.get");
  const double seconds = static_cast<double>(now() - begun) / 1e9;
  const double took = static_cast<double>(daemon.processor_time() - busy) / 1e6 / seconds;
  const int received = clients.received;
  if (clients.refused() || found.empty()) return false;
  std::vector<double> p50;
  std::vector<double> p99;
  int missed = 0;
  for (const Json& component : found["components"]) {
    p50.push_back(component["lateness"]["p50_ns"].get<double>() / 1e3);
    p99.push_back(component["lateness"]["p99_ns"].get<double>() / 1e3);
    missed += component["missed"].get<int>();
  }
  const auto judged = missed == 0 ? mauve::test::MissedReleases{} : daemon.missed(since);
  sweep.add(count, {median(p50), percentile(p99, 100), took, received / seconds,
                    static_cast<double>(judged.missed), static_cast<double>(judged.disturbed)});
  return true;
}

}  // namespace

void sweep_clients(Book& book, const Options& options) {
  const bool crowd = Crowd::possible();
  const Duration time = std::chrono::milliseconds(options.choose(4000, 300));
  Sweep sweep(
      "clients",
      "Clients at once on a mauved with " + std::to_string(kWatched) + " components of 1 kHz",
      "clients",
      {{"begins after its release, p50, us", "us a client"},
       {"p99 of the worst, us", "us a client"},
       {"mauved busy, ms a second", "ms a client"},
       {"values and answers, 1/s", "1/s a client"},
       {"releases missed", "", true},
       {"missed while disturbed", "", true}});
  bool measured = true;
  for (int round = 0; round < options.rounds && measured; ++round) {
    const Daemon daemon(crowd);
    measured = daemon.up();
    for (const int count : {0, 1, 8, 32}) {
      if (!crowd && count > static_cast<int>(Crowd::kOfOneUser)) continue;
      measured = measured && measure(sweep, daemon, count, time);
    }
  }
  must_hold(measured, "mauved did not come up, or refused a client");
  sweep.print(book);
  book.text(
      "Half of them (the first one, too) watch an observable of each component, which is looked at "
      "100 times a second; the others ask for statistics and status in turn, ten times a second. "
      "They run on the same CPUs, as ordinary threads. By the statistics and the trace of mauved, "
      "which root asks for beside them; mauved's busy time is that of its components and of a "
      "probe "
      "on each CPU, too.");
  if (!crowd) book.text(std::string("NOT MEASURED: 32 clients; ") + Crowd::kNotPossible + ".");
}

}  // namespace bench::scale
