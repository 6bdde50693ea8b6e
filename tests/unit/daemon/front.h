// SPDX-License-Identifier: LGPL-3.0-or-later
/// A deployed system, and the table of commands in front of it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "commands/table.h"
#include "judge/judge.h"
#include "monitor/watch.h"
#include "supervision/supervisor.h"
#include "support/answer_check.h"

namespace mauve::daemon {

/// `System`: an architecture, made without arguments; on a simulated clock.
template <typename System>
class Front : public testing::Test {
 protected:
  void SetUp() override {
    running.judge = [this](const Asker&, const Question& question, const Judge::Then& then) {
      control.read([=] { then(judge(question, plugin::Catalog())); });
    };
    running.judge_change = [this](const Question& question, const Judge::Then& then) {
      running.judge({}, question, then);
    };
    ASSERT_TRUE(deployer.deploy());
    log.start();
    control.start();
    watches.start(running);
  }
  void TearDown() override {
    control.stop();
    watches.stop();
    log.stop();
  }

  server::Outcome ask(server::Role role, const std::string& method, Json params = Json::object()) {
    auto answered = std::make_shared<std::promise<server::Outcome>>();
    auto outcome = answered->get_future();
    const server::Caller caller{1, {100, 1000, {}}, role, outbox};
    table.dispatch(caller, *protocol::find_method(method), {1, method, std::move(params)},
                   [answered](server::Outcome out) { answered->set_value(std::move(out)); });
    auto answer = outcome.get();
    if (const auto* result = std::get_if<Json>(&answer)) {
      EXPECT_THAT(test::misfits(*protocol::find_method(method), *result), testing::IsEmpty());
    }
    return answer;
  }
  Fault refused(server::Role role, const std::string& method, Json params = Json::object()) {
    auto outcome = ask(role, method, std::move(params));
    const auto* fault = std::get_if<Fault>(&outcome);
    return fault == nullptr ? Fault() : *fault;
  }

  System architecture;
  Deployer deployer{architecture, {Realtime::off, true}};
  plugin::Catalog catalog;
  Control control;
  logging::Log log{logging::Level::debug};
  Watches watches{log};
  Supervisor supervisor{control};
  Running running{architecture, deployer,
                  catalog,      control,
                  log,          watches,
                  supervisor,   [] { return std::vector<server::ClientInfo>(); },
                  "b007",       std::chrono::steady_clock::now()};
  CommandTable table{running};
  std::shared_ptr<server::Outbox> outbox = std::make_shared<server::Outbox>(1000, 4, [] {});
};

}  // namespace mauve::daemon
