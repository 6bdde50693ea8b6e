// SPDX-License-Identifier: LGPL-3.0-or-later
/// A deployer on a simulated clock whose trace must obey the model at its end, as check-trace
/// judges it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include <mauve/host/deployer.h>
#include <mauve/trace.h>

#include "mtrace/check.h"
#include "mtrace/file.h"
#include "trace/file.h"

namespace mauve::test {

class ProvedDeployer : public Deployer {
 public:
  explicit ProvedDeployer(Architecture& architecture, DeployOptions options = {.simulated = true})
      : Deployer(architecture, std::move(options)) {
    set_trace_mode(TraceMode::jobs);
  }
  ~ProvedDeployer() {
    EXPECT_FALSE(ran_ >= std::chrono::seconds(1) && recording_.records.empty()) << "no record";
    if (recording_.records.empty()) return;
    collect();
    set_trace_mode(TraceMode::off);
    prove();
  }
  ProvedDeployer(const ProvedDeployer&) = delete;
  ProvedDeployer& operator=(const ProvedDeployer&) = delete;

  /// As Deployer::run_for(), in pieces that the ring of a thread holds.
  void run_for(Duration duration) {
    constexpr Duration kPiece = std::chrono::milliseconds(200);
    ran_ += duration;
    do {
      Deployer::run_for(std::min(duration, kPiece));
      collect();
      duration -= kPiece;
    } while (duration > Duration{0});
  }

 private:
  void collect() {
    drain_trace([this](const TraceRecord& record) { recording_.records.push_back(record); });
  }
  void prove() {
    recording_.about = traced();
    std::stable_sort(recording_.records.begin(), recording_.records.end(),
                     [](const TraceRecord& x, const TraceRecord& y) { return x.time < y.time; });
    ctl::mtrace::Builder builder;
    EXPECT_TRUE(builder.header(daemon::header_of(recording_, "")));
    for (const TraceRecord& record : recording_.records) builder.record(daemon::to_json(record));
    builder.complete();
    const ctl::mtrace::Verdict verdict = ctl::mtrace::check(builder.take());
    EXPECT_GT(verdict.checked.components, 0U);
    if (verdict.holds()) return;
    ADD_FAILURE() << verdict.found
                  << " violations in the trace of this test, the first: " << verdict.first->thread
                  << ": " << verdict.first->message;
  }

  daemon::Recording recording_;
  Duration ran_{0};
};

}  // namespace mauve::test
