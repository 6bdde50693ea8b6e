// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/slots.h"

#include <gtest/gtest.h>

#include <vector>

namespace mauve::server {
namespace {

constexpr uid_t kAnn = 1001;
constexpr uid_t kBob = 1002;

Slot ordinary(std::uint64_t client, uid_t uid, Role role, bool idle) {
  return {client, uid, role, false, idle};
}
Slot stopping(std::uint64_t client, uid_t uid, bool idle) {
  return {client, uid, Role::operator_, true, idle};
}

/// Room for two clients, and for two that stop, one of each user.
Limits small_limits() {
  Limits limits;
  limits.clients = 2;
  limits.clients_per_uid = 2;
  limits.reserved_for_root = 0;
  limits.reserved_for_stop = 2;
  limits.stops_per_uid = 1;
  return limits;
}

Result<Entry> enters(uid_t uid, Role role, const std::vector<Slot>& slots,
                     std::string_view since = {}) {
  return entry_for({1, uid, {}}, role, since, small_limits(), slots);
}

TEST(Slots, LetAClientInWhileThereIsRoom) {
  const auto entry = enters(kAnn, Role::viewer, {ordinary(1, kAnn, Role::viewer, false)});

  ASSERT_TRUE(entry);
  EXPECT_TRUE(entry->only_urgent_since.empty());
  EXPECT_EQ(entry->displaced, 0U);
}

TEST(Slots, OfAnIdleViewerGoToAnOperatorBeforeThoseOfOneThatAsks) {
  const auto entry =
      enters(kBob, Role::operator_,
             {ordinary(1, kAnn, Role::viewer, false), ordinary(2, kAnn, Role::viewer, true)});

  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->displaced, 2U);
}

TEST(Slots, OfViewersGoToAnOperatorAlsoWhenAllOfThemAsk) {
  const auto entry =
      enters(kBob, Role::operator_,
             {ordinary(1, kAnn, Role::viewer, false), ordinary(2, kAnn, Role::viewer, false)});

  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->displaced, 1U);
}

TEST(Slots, OfAnOperatorWhoWaitsForAnAnswerStayWithHim) {
  const auto entry = enters(
      kBob, Role::admin,
      {ordinary(1, kAnn, Role::operator_, false), ordinary(2, kAnn, Role::operator_, false)});

  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->displaced, 0U);
  EXPECT_EQ(entry->only_urgent_since, kAllSlotsInUse);
}

TEST(Slots, OfAClientThatStopsAreNeverGivenToAnotherBeforeItsAnswer) {
  EXPECT_FALSE(enters(kAnn, Role::operator_, {stopping(1, kAnn, false)}, kWayOfStops));
  EXPECT_FALSE(enters(kAnn, Role::operator_, {stopping(1, kAnn, false), stopping(2, kBob, true)},
                      kWayOfStops))
      << "one that the other user does not need is not for the third client of this one";
  EXPECT_FALSE(enters(kAnn, Role::operator_, {stopping(1, kBob, false), stopping(2, 1003, false)},
                      kWayOfStops));
}

TEST(Slots, OfAClientThatHasItsAnswerGoToTheNextStop) {
  const auto own = enters(kAnn, Role::operator_, {stopping(1, kAnn, true)}, kWayOfStops);
  const auto other = enters(kAnn, Role::operator_,
                            {stopping(1, kBob, false), stopping(2, 1003, true)}, kWayOfStops);

  ASSERT_TRUE(own);
  EXPECT_EQ(own->displaced, 1U);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->displaced, 2U);
}

TEST(Slots, ForStopsAreNotForViewers) {
  EXPECT_FALSE(enters(kAnn, Role::viewer, {}, kWayOfStops));
  EXPECT_FALSE(enters(kAnn, Role::viewer, {}, kNoDescriptor));
  EXPECT_TRUE(enters(kAnn, Role::operator_, {}, kNoDescriptor));
}

TEST(Slots, ForStopsCostNobodyHisOrdinaryOne) {
  const auto entry = enters(kBob, Role::admin, {stopping(1, kAnn, false), stopping(2, kBob, true)});

  ASSERT_TRUE(entry);
  EXPECT_TRUE(entry->only_urgent_since.empty());
  EXPECT_EQ(entry->displaced, 0U);
}

}  // namespace
}  // namespace mauve::server
