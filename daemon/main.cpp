// SPDX-License-Identifier: LGPL-3.0-or-later
#include <cerrno>
#include <cstring>
#include <exception>
#include <iostream>

#include "base/standard_streams.h"
#include "base/thread_role.h"
#include "daemon.h"
#include "judge/child.h"
#include "options.h"
#include "rt/thread/stack.h"

namespace {

/// A file of which a part is missing must not look like a whole one.
int exit_of(int exit) {
  std::cout.flush();
  if (std::cout.good()) return exit;
  std::cerr << "error: the output of mauved cannot be written: " << std::strerror(errno) << "\n";
  return exit == 0 ? 1 : exit;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace mauve::daemon;
  mauve::occupy_standard_streams();
  mauve::keep_c_locale();
  mauve::rt::set_default_stack(mauve::rt::kOrdinaryStack);
  try {
    const auto parsed = parse_options(argc, argv);
    if (const auto* leave = std::get_if<Leave>(&parsed)) {
      (leave->exit == 0 ? std::cout : std::cerr) << leave->text;
      return exit_of(leave->exit);
    }
    const auto& options = std::get<Options>(parsed);
    if (options.judge) {
      return judge_as_child(options);
    }
    return options.check ? exit_of(check_file(options)) : Daemon(options).run();
  } catch (const std::exception& error) {
    // Every other door is shut: this is a fault of mauved or of the machine (out of memory).
    std::cerr << "error: " << error.what() << "\n";
    return 1;
  }
}
