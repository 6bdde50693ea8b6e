// SPDX-License-Identifier: LGPL-3.0-or-later
/// Makes a man page from its template: generate SOURCES TEMPLATE VERSION OUTPUT.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "pages.h"

int main(int count, char** words) {
  if (count != 5) {
    std::fputs("usage: generate SOURCES TEMPLATE VERSION OUTPUT\n", stderr);
    return 2;
  }
  std::ifstream stream(words[2], std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (std::size_t at = 0; (at = text.find("@VERSION@", at)) != std::string::npos;) {
    text.replace(at, 9, words[3]);
  }
  const auto page = mauve::man::page(text, words[1]);
  if (!stream || !page) {
    std::fprintf(stderr, "%s: %s\n", words[2],
                 page ? "cannot be read" : mauve::to_string(page.error()).c_str());
    return 1;
  }
  std::ofstream out(words[4], std::ios::binary);
  out << *page << std::flush;
  return out.good() ? 0 : 1;
}
