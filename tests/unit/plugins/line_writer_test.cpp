// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "../../../plugins/drivers/line_writer.h"

namespace {

using drivers::LineWriter;
using drivers::PseudoTerminal;
using drivers::SerialPort;

namespace fs = std::filesystem;

std::string writer_link(const char* name) {
  return (fs::path(testing::TempDir()) / (std::string("mauve_writer_") + name)).string();
}

std::string heard(const PseudoTerminal& line) {
  std::array<char, 4096> bytes{};
  return {bytes.data(), line.receive(bytes)};
}

TEST(LineWriter, SendsBytesUnchanged) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(writer_link("unchanged")));
  LineWriter writer;
  writer.choose(writer_link("unchanged"));

  EXPECT_EQ(heard(line), "");
  EXPECT_TRUE(writer.send(std::string_view("QT\n\0\x13\x91", 6)));
  EXPECT_EQ(heard(line), std::string("QT\n\0\x13\x91", 6));
}

TEST(LineWriter, FindsADeviceThatCameAnew) {
  const std::string link = writer_link("anew");
  LineWriter writer;
  writer.choose(link);
  EXPECT_FALSE(writer.send("early"));
  PseudoTerminal line;
  ASSERT_TRUE(line.open(link));
  EXPECT_TRUE(writer.send("one"));
  line.close();
  EXPECT_FALSE(writer.send("lost"));
  ASSERT_TRUE(line.open(link));

  EXPECT_TRUE(writer.send("two"));
  EXPECT_EQ(heard(line), "two");
}

TEST(LineWriter, WritesIntoNoPlainFile) {
  const std::string path = writer_link("precious");
  std::ofstream(path) << "a recording";
  LineWriter writer;
  writer.choose(path);

  EXPECT_FALSE(writer.send("QT\n"));
  EXPECT_EQ(fs::file_size(path), 11U);
  fs::remove(path);
}

TEST(LineWriter, NeverSendsHalfARequestOnAFullLine) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  LineWriter writer;
  writer.choose(line.device());
  const std::string request = "0123456";  // 7 divides no power of two
  std::size_t sent = 0;
  std::size_t refused = 0;
  while (refused < 3) (writer.send(request) ? sent : refused) += 1;
  std::string all;
  for (std::string some = heard(line); !some.empty(); some = heard(line)) all += some;
  while (!writer.send(request)) all += heard(line);
  ++sent;
  for (std::string some = heard(line); !some.empty(); some = heard(line)) all += some;

  ASSERT_EQ(all.size(), sent * request.size());
  for (std::size_t at = 0; at < all.size(); at += request.size()) {
    ASSERT_EQ(all.substr(at, request.size()), request);
  }
}

}  // namespace
