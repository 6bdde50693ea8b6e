// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauved and mauvectl as processes of a test, ended with it.
#pragma once

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/eventually.h"
#include "support/process.h"
#include "support/proved_trace.h"
#include "support/temp_dir.h"

namespace mauve::test {

/// A daemon on a socket of its own, and the client for it. MAUVE_BIN_DIR and MAUVE_PLUGIN_DIR are
/// defined by the CMakeLists.txt of the test.
class DaemonProcess {
 public:
  explicit DaemonProcess(const std::filesystem::path& architecture,
                         std::vector<std::string> more = {"--realtime", "off"})
      : socket_((place_ / "mauved.sock").string()),
        errors_((place_ / "errors.txt").string()),
        daemon_(command(architecture, std::move(more)), errors_) {}
  ~DaemonProcess() {
    expect_trace_obeys_the_model(socket_, daemon_, place_.path());
    daemon_.signal(SIGTERM);
  }

  /// True when it answers.
  [[nodiscard]] bool up(std::chrono::milliseconds within = std::chrono::minutes(1)) {
    const auto answers = [this] { return !daemon_.running() || client({"ping"}).wait() == 0; };
    return eventually(answers, within) && daemon_.running();
  }
  [[nodiscard]] Process& process() { return daemon_; }
  [[nodiscard]] const std::string& socket() const { return socket_; }
  /// The text on standard error so far.
  [[nodiscard]] std::string errors() const { return TempDir::read(errors_); }
  /// Waits until the log has this text; the log is written a little later than events happen.
  [[nodiscard]] bool says(const std::string& text) const {
    return eventually([&] { return errors().find(text) != std::string::npos; });
  }

  /// The command line of `mauvectl --json WORDS...`.
  [[nodiscard]] std::vector<std::string> client_words(const std::vector<std::string>& words) const {
    std::vector<std::string> all = mauvectl_words(socket_, {"--json"});
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  /// The client, still running.
  [[nodiscard]] Process client(const std::vector<std::string>& words) const {
    return Process(client_words(words), errors_);
  }
  /// Its answer; discarded when it was not JSON.
  [[nodiscard]] nlohmann::json ask(const std::vector<std::string>& words) const {
    return nlohmann::json::parse(client(words).all_output(), nullptr, false);
  }
  /// The value at an address.
  [[nodiscard]] nlohmann::json value(const std::string& address) const {
    const nlohmann::json answer = ask({"get", address});
    return answer.is_object() && answer.contains("value") ? answer["value"] : nlohmann::json();
  }

 private:
  [[nodiscard]] std::vector<std::string> command(const std::filesystem::path& architecture,
                                                 std::vector<std::string> more) const {
    std::vector<std::string> words{
        MAUVE_BIN_DIR "/mauved", architecture.string(), "--socket", socket_,
        "--plugin-dir",          MAUVE_PLUGIN_DIR};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  TempDir place_;
  std::string socket_;
  std::string errors_;
  Process daemon_;
};

}  // namespace mauve::test
