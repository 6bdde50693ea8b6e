// SPDX-License-Identifier: LGPL-3.0-or-later
/// One run of mauvectl: the command that was asked, the connection it needs, where it answers.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <variant>

#include "cli/client.h"
#include "cli/command.h"
#include "cli/screen.h"
#include "render/render.h"

namespace mauve::ctl {

class Session {
 public:
  Session(const Command& command, Arguments arguments, Globals globals, Screen screen);

  const Command& command;
  const Arguments arguments;
  const Globals globals;
  Screen screen;

  /// Connects at the first call. A stop, confirm or undo that finds no room is sent again until
  /// --timeout, and a stop also when its answer is lost. A method that changes something also gets
  /// if_generation, reason and deadline; others are refused with them.
  [[nodiscard]] std::variant<Json, Fault> call(std::string_view method, Json params);
  using Deadline = Client::Deadline;
  [[nodiscard]] std::variant<Notification, Fault> next(Deadline deadline = Deadline::max()) {
    return client_.next(deadline);
  }
  /// For a command that goes on until Ctrl-C: ends it as a write would when the reader of its
  /// output is gone. A value may not come for hours.
  static void end_without_a_reader();

  /// Prints one line of JSON, or the text. Flushed, so that a pipe sees it at once.
  void print(const Json& value, std::string_view text);
  /// Prints the error in its four parts, or as JSON. Returns its exit code.
  int fail(const Fault& fault);
  /// The request of the user, for messages: "swap-core arm"; of several arguments the one at
  /// `where`.
  [[nodiscard]] std::string asked(std::string_view where) const;
  /// The option that was given for this parameter of the wire ("--dry-run" for "dry_run"); the same
  /// text for anything else.
  [[nodiscard]] std::string as_typed(std::string_view where) const;
  [[nodiscard]] Look look() const { return {screen.width, screen.colour_out}; }

 private:
  /// With --wait again and again until mauved answers or the time is over.
  std::optional<Fault> connect(bool urgent);
  std::variant<Json, Fault> call_urgently(std::string_view method, const Json& params,
                                          std::chrono::nanoseconds timeout);

  Client client_;
  bool connected_ = false;
  bool urgent_ = false;  ///< connected for stop, confirm and undo only
};

/// A file that cannot be read or written is wrong use.
[[nodiscard]] Fault bad_file(const Error& error);

/// {"text", "file"}: the content of FILE, and its name.
[[nodiscard]] std::variant<Json, Fault> file_params(const Session& session,
                                                    std::string_view argument = "FILE");

/// A number and a unit, "5s"; checked by the option parser.
[[nodiscard]] std::optional<std::chrono::nanoseconds> timeout_of(std::string_view text);

}  // namespace mauve::ctl
