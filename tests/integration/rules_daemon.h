// SPDX-License-Identifier: LGPL-3.0-or-later
/// A daemon whose file has transactions and rules.
#pragma once

#include <string>

#include "trial_daemon.h"

namespace mauve::test {

/// `second` reads what `first` writes: its gain. Deaf it reads 0.5.
inline std::string supervised(const std::string& rules, const std::string& may_request = "[]") {
  std::string text(kTrial);
  const std::string resources = "\"resources\"";
  text.insert(text.find(resources), R"("transactions": {
      "deaf": [{ "disconnect": "second.ports.input" }],
      "calm": [{ "set": "first.core.gain", "value": 1.0 }],
      "worse": [{ "disconnect": "second.ports.input" },
                { "swap": "first", "core": "trial/refusing" }],
      "rest": [{ "stop": "second" }],
      "wake": [{ "start": "second" }] },
    "rules": [)" + rules + "],\n");
  const std::string first = R"({ "type": "trial/unit", "properties": { "fsm.period": "2ms" },)";
  return text.replace(text.find(first), first.size(),
                      first + "\"may_request\": " + may_request + ", ");
}

class RulesDaemon : public TrialDaemon {
 public:
  using TrialDaemon::TrialDaemon;

  Json rule(const std::string& name) { return ask("rules.list", {{"rule", name}})["items"][0]; }
  Json set(const std::string& address, const Json& value) {
    return ask("param.set", {{"values", {{address, value}}}});
  }
  /// The service that a port is connected to, or null.
  Json service(const std::string& port) {
    return ask("object.get", {{"address", port}})["service"];
  }
  /// How many records of this event there are, with this part in their text.
  std::size_t events(const std::string& name, const std::string& part = "") {
    const auto tail = ask("log.tail", {{"n", 1000}});
    std::size_t count = 0;
    for (const auto& record : tail["records"]) {
      const auto text = record["text"].get<std::string>();
      count += record["event"] == name && text.find(part) != std::string::npos ? 1U : 0U;
    }
    return count;
  }
  /// As soon as there are so many of them; the log is written a little later than events happen.
  bool logs(std::size_t times, const std::string& name, const std::string& part = "") {
    return eventually([&] { return events(name, part) == times; });
  }
  /// How often these words stand in the whole log.
  std::size_t said(const std::string& words) const {
    const auto log = errors();
    std::size_t count = 0;
    for (auto at = log.find(words); at != std::string::npos; at = log.find(words, at + 1)) {
      ++count;
    }
    return count;
  }
  /// It has fired so often, or more often by now, and the last time has its answer.
  bool fired(const std::string& name, int times) {
    return eventually([&] {
      const auto row = rule(name);
      return row["fired"] >= times && row["answer"] != "" && row["answer"] != "under way";
    });
  }
  std::string answer(const std::string& name) { return rule(name)["answer"].get<std::string>(); }
};

}  // namespace mauve::test
