// SPDX-License-Identifier: LGPL-3.0-or-later
// The differences that a rollback of changes on probation makes.
#include "commands/recovery/rollback_lines.h"

#include <gtest/gtest.h>

#include "mauve/host/receipt.h"
#include "mauve/host/retired.h"

namespace mauve::daemon {
namespace {

using protocol::Json;

Json line(const char* address, Json before, Json after) {
  const char* op = before.is_null() ? "add" : after.is_null() ? "remove" : "change";
  return {{"op", op},
          {"kind", "property"},
          {"address", address},
          {"old", std::move(before)},
          {"new", std::move(after)}};
}

TEST(RollbackLines, LeadFromTheLastValueToTheFirst) {
  RollbackLines lines;
  lines.remember(2, Json::array({line("a.core.x", 1, 2)}));
  lines.remember(3, Json::array({line("b.core.y", 5, 6)}));
  lines.remember(4, Json::array({line("a.core.x", 2, 7)}));

  EXPECT_EQ(lines.back_from({2, 4}), Json::array({line("a.core.x", 7, 1)}));
  EXPECT_EQ(lines.back_from({3}), Json::array({line("b.core.y", 6, 5)}));
  EXPECT_EQ(lines.back_from({9}), Json::array()) << "nothing is known of it";
}

TEST(RollbackLines, TakeAwayTheAddedAndAddTheRemoved) {
  RollbackLines lines;
  lines.remember(2, Json::array({line("a.ports.in", nullptr, "pose.read"),
                                 line("a.ports.out", "scan.write", nullptr)}));

  EXPECT_EQ(lines.back_from({2}), Json::array({line("a.ports.in", "pose.read", nullptr),
                                               line("a.ports.out", nullptr, "scan.write")}));
}

TEST(RollbackLines, LeaveOutWhatIsAgainAsItWas) {
  RollbackLines lines;
  lines.remember(2, Json::array({line("a.core.x", 1, 2)}));
  lines.remember(3, Json::array({line("a.core.x", 2, 1)}));

  EXPECT_EQ(lines.back_from({2, 3}), Json::array());
}

TEST(RollbackLines, KnowWhatALaterStartOrStopMadeOfIt) {
  RollbackLines lines;
  lines.remember(2, Json::array({line("a.start", true, false)}));
  lines.remember(3, Json::array({line("a.start", false, true), line("b.start", false, true)}));

  EXPECT_EQ(lines.back_from({2}), Json::array()) << "it runs already";
}

TEST(RollbackLines, AreForgottenWithTheirChangesAndBounded) {
  RollbackLines lines;
  for (std::uint64_t generation = 1; generation <= RollbackLines::kMost + 1; ++generation) {
    lines.remember(generation, Json::array({line("a.core.x", 1, 2)}));
  }
  EXPECT_EQ(lines.back_from({1}), Json::array()) << "the oldest";
  EXPECT_EQ(lines.back_from({2}).size(), 1U);

  lines.forget({2});

  EXPECT_EQ(lines.back_from({2}), Json::array());
}

struct Way final : Ongoing {
  Retired nothing;

  void make(std::uint64_t generation) { made_ = generation; }
  bool advance() override { return false; }
  [[nodiscard]] Result<Receipt> result() const override { return Receipt(); }
  Retired& retired() override { return nothing; }
};

TEST(RollbackLines, OfAChangeUnderWayCountOnceItHasMadeItsGeneration) {
  RollbackLines lines;
  lines.remember(2, Json::array({line("a.core.x", 1, 2)}));
  auto way = std::make_shared<Way>();
  lines.expect(way, Json::array({line("a.core.x", 2, 1)}));
  EXPECT_EQ(lines.back_from({2}), Json::array({line("a.core.x", 2, 1)}));

  way->make(3);
  EXPECT_EQ(lines.back_from({3}), Json::array({line("a.core.x", 1, 2)}));

  way.reset();
  EXPECT_EQ(lines.back_from({2}), Json::array({line("a.core.x", 2, 1)})) << "it was refused";
}

}  // namespace
}  // namespace mauve::daemon
