// SPDX-License-Identifier: LGPL-3.0-or-later
/// simulated_device LINK: a thermometer on a pseudo-terminal, to which LINK leads. It sends 21.50
/// ten times a second until it is ended.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "pseudo_terminal.h"

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: simulated_device LINK\n");
    return 2;
  }
  const PseudoTerminal line;
  std::filesystem::remove(words[1]);
  std::filesystem::create_symlink(line.path(), words[1]);
  while (line.send("21.50\n")) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return 1;
}
