// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauvectl: shows and changes the system that runs in mauved.
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "base/standard_streams.h"
#include "cli/complete.h"
#include "cli/interrupt.h"
#include "cli/options.h"
#include "cli/session.h"

namespace {

using namespace mauve::ctl;

/// Ends at once, as if there were no handler, but warns that a change may still go on.
extern "C" void end_at_once(int signal_number) {
  constexpr char kText[] =
      "\nmauvectl: stopped waiting; the daemon may still carry out the change\n";
  if (g_change_awaited != 0) [[maybe_unused]]
    const auto written = write(2, kText, sizeof kText - 1);
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

Colour colour_of(const std::string& name) {
  if (name == "always") return Colour::always;
  return name == "never" ? Colour::never : Colour::automatic;
}

int refuse_use(const Misuse& misuse) {
  const Screen screen = standard_screen(misuse.json, colour_of(misuse.colour));
  if (screen.json) {
    screen.out << mauve::protocol::to_line(fault_json(misuse.fault)) << std::endl;
  } else {
    screen.err << render_fault({}, misuse.fault, {screen.width_err, screen.colour_err});
  }
  return misuse.fault.exit;
}

/// A file of which a part is missing must not look like a whole one.
int refuse_output(int reason) {
  std::cout.exceptions(std::ios::goodbit);
  std::cerr << "error: the output of mauvectl cannot be written: " << std::strerror(reason)
            << "\n  state  : mauved carries out what it was asked for all the same\n"
            << (reason == EPIPE
                    ? "  hint   : its reader has ended; ask again with another one\n"
                    : "  hint   : open standard output, and free the disk that it leads to; "
                      "then ask again\n");
  return 1;
}

int run(const std::vector<std::string>& words) {
  if (!words.empty() && words.front() == "__complete") {
    std::cout << completion_lines(complete({words.begin() + 1, words.end()}));
    return 0;
  }
  constexpr std::size_t kPiped = 80;
  const std::size_t width = standard_screen(false, Colour::never).width;
  auto parsed = parse_options(words, width == 0 ? kPiped : width);
  if (const auto* misuse = std::get_if<Misuse>(&parsed)) return refuse_use(*misuse);
  if (const auto* text = std::get_if<Text>(&parsed)) {
    std::cout << text->text;
    return 0;
  }
  auto& asked = std::get<Invocation>(parsed);
  const Screen screen = standard_screen(asked.globals.json, colour_of(asked.globals.colour));
  Session session(*asked.command, std::move(asked.arguments), std::move(asked.globals), screen);
  return asked.command->run(session);
}

}  // namespace

int main(int count, char** words) {
  mauve::occupy_standard_streams();
  // In the background of a script SIGINT is ignored, and stays so.
  if (signal(SIGINT, end_at_once) == SIG_IGN) signal(SIGINT, SIG_IGN);
  signal(SIGTERM, end_at_once);
  // The last door: a full memory or a library's surprise is an error with an exit code, not a
  // crash.
  std::cout.exceptions(std::ios::badbit);
  try {
    const int exit = run({words + 1, words + count});
    std::cout.flush();
    return exit;
  } catch (const std::ios::failure&) {
    return refuse_output(errno);
  } catch (const std::exception& error) {
    std::cerr << "error: mauvectl failed: " << error.what() << '\n';
    return 1;
  }
}
