// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauved on an architecture of two components from the plugin "trial", in a directory of the test.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "support/answer_check.h"
#include "support/daemon_process.h"
#include "support/raw_client.h"
#include "support/temp_dir.h"

namespace mauve::test {

using Json = protocol::Json;

inline constexpr const char* kTrial = R"({
  "schema": "mauve/architecture/1",
  "name": "trial",
  "plugins": ["trial"],
  "resources": {
    "signal": { "type": "shared_data", "data": "double" },
    "count": { "type": "shared_data", "data": "int64" }
  },
  "components": {
    "first":  { "type": "trial/unit", "properties": { "fsm.period": "2ms" },
                "ports": { "output": "signal.write" } },
    "second": { "type": "trial/unit", "properties": { "fsm.period": "5ms" },
                "ports": { "input": "signal.read" } }
  }
})";

/// The same; no guard ends a job of `first`.
inline std::string unguarded() {
  std::string text(kTrial);
  const std::string type = R"("trial/unit",)";
  return text.replace(text.find(type), type.size(), type + R"( "task": { "watchdog": "1h" },)");
}

/// Every answer that a test asks for holds only what the row of its method names.
inline void expect_answer_of_its_row(std::string_view name, const protocol::Json& answer) {
  const auto* method = protocol::find_method(name);
  if (method != nullptr) {
    EXPECT_THAT(misfits(*method, answer), testing::IsEmpty());
  }
}

class TrialDaemon {
 public:
  explicit TrialDaemon(const std::string& architecture = kTrial,
                       std::vector<std::string> more = {"--realtime", "off"},
                       std::string program = MAUVE_BIN_DIR "/mauved")
      : file_(place_.write("trial.json", architecture)),
        more_(std::move(more)),
        program_(std::move(program)) {
    std::filesystem::create_directory(plugins());
    install(1);
    start();
  }

  ~TrialDaemon() {
    if (process_ != nullptr) {
      expect_trace_obeys_the_model(socket().string(), *process_, place_.path());
    }
    if (testing::Test::HasFailure()) std::cout << "mauved had said:\n" << errors();
  }
  TrialDaemon(const TrialDaemon&) = delete;
  TrialDaemon& operator=(const TrialDaemon&) = delete;

  /// Puts build 1, 2 or 3 of the plugin in place, as a build tool does: a new file, then its name.
  void install(int number) const {
    const auto from = std::filesystem::path(MAUVE_TRIAL_DIR) / std::to_string(number) / "trial.so";
    std::filesystem::copy_file(from, plugins() / "new",
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::rename(plugins() / "new", plugins() / "trial.so");
  }
  void start(const std::vector<std::string>& also = {}) {
    auto words = command();
    words.insert(words.end(), also.begin(), also.end());
    process_ = std::make_unique<Process>(words, errors_path());
  }

  /// A client that has read its greeting; gives up when the daemon has ended.
  [[nodiscard]] RawClient client() {
    std::unique_ptr<RawClient> found;
    static_cast<void>(eventually([&] {
      found = std::make_unique<RawClient>(socket());
      found->on_answer = expect_answer_of_its_row;
      return (found->connected() && !found->json().is_null()) || !process_->running();
    }));
    return std::move(*found);
  }
  /// One question on a connection of its own: the result, or the object under "error".
  Json ask(const std::string& method, Json params = Json::object()) {
    auto asking = client();
    auto answer = asking.ask(method, std::move(params));
    return answer.contains("result") ? answer["result"] : answer["error"];
  }
  /// `mauvectl WORDS...`, to its end.
  Said ctl(const std::vector<std::string>& words) const {
    return mauvectl(socket().string(), words, (place_ / "client.txt").string());
  }
  Json value(const std::string& address) {
    return ask("param.get", {{"address", address}})["value"];
  }
  Json component(const std::string& name) {
    const auto status = ask("status.get");
    for (const auto& row : status["components"]) {
      if (row["name"] == name) {
        return row;
      }
    }
    return nullptr;
  }
  /// Waits until the value at an address is `wanted`.
  [[nodiscard]] bool becomes(const std::string& address, const Json& wanted) {
    return eventually([&] { return value(address) == wanted; });
  }

  [[nodiscard]] Process& process() { return *process_; }
  [[nodiscard]] std::filesystem::path socket() const { return place_ / "mauved.sock"; }
  [[nodiscard]] std::filesystem::path plugins() const { return place_ / "plugins"; }
  [[nodiscard]] const TempDir& place() const { return place_; }
  [[nodiscard]] std::string errors() const { return TempDir::read(errors_path()); }
  /// Waits until the log has this text; the log is written a little later than events happen.
  [[nodiscard]] bool says(const std::string& text) const {
    return eventually([&] { return errors().find(text) != std::string::npos; });
  }
  [[nodiscard]] std::vector<std::string> command() const {
    std::vector<std::string> words = {program_,          file_.string(), "--socket",
                                      socket().string(), "--plugin-dir", plugins().string()};
    words.insert(words.end(), more_.begin(), more_.end());
    return words;
  }

 private:
  [[nodiscard]] std::string errors_path() const { return (place_ / "errors.txt").string(); }

  TempDir place_;
  std::filesystem::path file_;
  std::vector<std::string> more_;
  std::string program_;
  std::unique_ptr<Process> process_;
};

}  // namespace mauve::test
