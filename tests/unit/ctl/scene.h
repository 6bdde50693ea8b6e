// SPDX-License-Identifier: LGPL-3.0-or-later
/// Whole commands against a fake server: what is asked, what is printed, which exit code.
#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cli/options.h"
#include "cli/session.h"
#include "unit/ctl/fake_server.h"

namespace mauve::ctl {

struct Outcome {
  int exit = -1;
  std::string out;
  std::string err;
};

inline Outcome run(const std::string& socket, std::vector<std::string> words) {
  words.insert(words.begin(), {"--socket", socket});
  auto parsed = parse_options(words);
  if (auto* misuse = std::get_if<Misuse>(&parsed)) {
    ADD_FAILURE() << misuse->fault.message;
    return {};
  }
  auto& asked = std::get<Invocation>(parsed);
  std::ostringstream out;
  std::ostringstream err;
  Screen screen{out, err};
  screen.json = asked.globals.json;
  Session session(*asked.command, std::move(asked.arguments), std::move(asked.globals), screen);
  const int exit = asked.command->run(session);
  return {exit, out.str(), err.str()};
}

/// Runs a command against a server that gives every request the same answer; what was asked is
/// kept.
struct Scene {
  std::vector<protocol::Request> asked;
  Outcome outcome;

  Scene(std::vector<std::string> words, const Json& answer) {
    FakeServer server([&](Peer& peer) {
      peer.say(kHello);
      for (auto request = peer.hear(); !request.id.is_null(); request = peer.hear()) {
        peer.answer(request, answer);
        asked.push_back(std::move(request));
      }
    });
    outcome = run(server.path(), std::move(words));
  }
};

}  // namespace mauve::ctl
