// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests of clients that are not there any more.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>

#include "mauve/host/architecture.h"
#include "support/eventually.h"
#include "unit/daemon/front.h"

namespace mauve::daemon {
namespace {

using server::Role;

struct NoElements : Architecture {};
class GoneClients : public Front<NoElements> {};

TEST_F(GoneClients, AreLookedAtForNoMore) {
  const auto gone = std::make_shared<server::Outbox>(1000, 1, [] {});
  std::promise<void> release;
  control.urgent([&] { release.get_future().wait(); });
  std::atomic<int> answered{0};
  for (int i = 0; i < 3; ++i) {
    for (const auto& its : {gone, outbox}) {
      table.dispatch({1, {100, 1000, {}}, Role::admin, its}, *protocol::find_method("status.get"),
                     {1, "status.get", Json::object()},
                     [&](const server::Outcome&) { ++answered; });
    }
  }
  gone->shut();
  release.set_value();

  EXPECT_TRUE(test::eventually([&] { return answered == 3; }));
  static_cast<void>(ask(Role::admin, "status.get"));  // behind them all
  EXPECT_EQ(answered, 3);
}

}  // namespace
}  // namespace mauve::daemon
