// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

namespace mauve::ctl {
namespace {

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

bool wants_colour(int descriptor, Colour colour) {
  if (colour != Colour::automatic) return colour == Colour::always;
  const char* term = std::getenv("TERM");
  const bool dumb = term == nullptr || std::string_view(term) == "dumb";
  return isatty(descriptor) == 1 && !is_set("NO_COLOR") && !dumb;
}

std::size_t width_of(int descriptor) {
  winsize size{};
  if (isatty(descriptor) != 1) return 0;
  if (ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

std::string_view escape(Paint paint) {
  switch (paint) {
    case Paint::plain:
      return "";
    case Paint::bold:
      return "\033[1m";
    case Paint::red:
      return "\033[1;31m";
    case Paint::green:
      return "\033[32m";
    case Paint::yellow:
      return "\033[33m";
  }
  return "";
}

}  // namespace

Screen standard_screen(bool json, Colour colour) {
  Screen screen{std::cout, std::cerr};
  screen.json = json;
  screen.colour_out = !json && wants_colour(STDOUT_FILENO, colour);
  screen.colour_err = wants_colour(STDERR_FILENO, colour);
  screen.width = json ? 0 : width_of(STDOUT_FILENO);
  screen.width_err = width_of(STDERR_FILENO);
  return screen;
}

std::string painted(std::string_view text, Paint paint, bool colour) {
  if (!colour || paint == Paint::plain) return std::string(text);
  std::string result(escape(paint));
  return result.append(text).append("\033[0m");
}

}  // namespace mauve::ctl
