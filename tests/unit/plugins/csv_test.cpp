// SPDX-License-Identifier: LGPL-3.0-or-later
// Values that `mauvectl record` writes are the same when they are read back.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../../../plugins/drivers/recording/csv_cell.h"
#include "../../../plugins/drivers/recording/csv_recording.h"
#include "../../../plugins/types/grid.h"
#include "../../../plugins/types/pose.h"
#include "../../../plugins/types/scan.h"

namespace {

using mauve::Value;
using Cells = std::vector<std::string>;

template <typename T>
std::vector<T> read_all(const std::string& text, const std::string& address = {}) {
  const auto rows = drivers::read_csv(text, mauve::data_type<T>(), address, "file");
  EXPECT_TRUE(rows) << mauve::to_string(rows.error());
  std::vector<T> values;
  for (const auto& row : rows->rows) {
    values.emplace_back();
    EXPECT_TRUE(mauve::data_type<T>().from_value(row.value, &values.back()));
  }
  return values;
}

template <typename T>
std::string refusal(const std::string& text, const std::string& address = {}) {
  const auto rows = drivers::read_csv(text, mauve::data_type<T>(), address, "file");
  return rows ? "accepted" : rows.error().message;
}

TEST(CsvCell, SplitsARowWithQuotesCommasAndLineEnds) {
  std::string_view text = "a,\"b,\"\"c\"\"\nd\",\r\nnext";
  std::size_t lines = 0;

  EXPECT_EQ(drivers::take_row(text, lines), (Cells{"a", "b,\"c\"\nd", ""}));
  EXPECT_EQ(lines, 2U);
  EXPECT_EQ(drivers::take_row(text, lines), Cells{"next"});
  std::string_view open = "a,\"b";
  EXPECT_EQ(drivers::take_row(open, lines), std::nullopt);
}

TEST(CsvCell, ReadsNumbersWordsAndLists) {
  EXPECT_EQ(drivers::value_of_cell("-9223372036854775808"), Value(std::int64_t{INT64_MIN}));
  EXPECT_EQ(drivers::value_of_cell("18446744073709551615"), Value(std::uint64_t{UINT64_MAX}));
  EXPECT_EQ(drivers::value_of_cell("18446744073709551616"), Value(0x1p64));
  EXPECT_EQ(drivers::value_of_cell("0.1"), Value(0.1));
  EXPECT_EQ(drivers::value_of_cell("5e-324"), Value(5e-324));
  EXPECT_EQ(drivers::value_of_cell("nan"), Value("nan"));
  EXPECT_EQ(drivers::value_of_cell("-inf"), Value("-inf"));
  EXPECT_EQ(drivers::value_of_cell("true"), Value(true));
  EXPECT_EQ(drivers::value_of_cell("[1,2.5,\"nan\",{\"x\":[]}]"),
            Value(Value::Array{1, 2.5, "nan", Value::Object{{"x", Value::Array{}}}}));
  for (const char* cut : {"[1,2", "{\"x\":1", "[1]]", "{x:1}"}) {
    EXPECT_EQ(drivers::value_of_cell(cut), std::nullopt) << cut;
  }
  EXPECT_EQ(drivers::value_of_cell(std::string(40, '[') + std::string(40, ']')), std::nullopt);
}

TEST(CsvRecording, ReadsTheRowsOfOneAddressAndLeavesGapsOut) {
  const std::string text =
      "time_s,a.read.x,a.read.y,b.read.x,b.read.y\n"
      "1.000000000,0.1,2.0,,\n"
      "1.500000000,,,7.0,8.0\n"
      "0.000000000,,,,\n"
      "2.000000001,nan,-inf,,\n";

  const auto rows = drivers::read_csv(text, mauve::data_type<rover::Point2D>(), "a.read", "file");
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->rows.size(), 2U);
  EXPECT_EQ(rows->rows[0].time, 1'000'000'000);
  EXPECT_EQ(rows->rows[1].time, 2'000'000'001);
  EXPECT_EQ(rows->rows[1].line, 5U);
  const auto values = read_all<rover::Point2D>(text, "a.read");
  EXPECT_EQ(values[0].x, 0.1);
  EXPECT_TRUE(std::isnan(values[1].x));
  EXPECT_EQ(values[1].y, -std::numeric_limits<double>::infinity());
}

TEST(CsvRecording, ReadsListsAndStructsWithinStructs) {
  const auto scans = read_all<rover::LaserScan>(
      "time_s,s.read.angle_min,s.read.ranges\n0.5,-1.5,\"[0.25,\"\"inf\"\"]\"\n");
  EXPECT_EQ(scans[0].angle_min, -1.5F);
  EXPECT_EQ(scans[0].ranges.size(), 2U);
  const auto paths =
      read_all<rover::Path>("time_s,p.read.points\n0.5,\"[{\"\"x\"\":1.5,\"\"y\"\":2.0}]\"\n");
  EXPECT_EQ(paths[0].points[0].x, 1.5);
}

TEST(CsvRecording, SaysWhatIsWrongAndWhere) {
  using rover::Point2D;
  EXPECT_EQ(refusal<Point2D>("x,y\n1,2\n"), "file:1: does not begin with the column \"time_s\"");
  EXPECT_EQ(refusal<Point2D>("time_s,a.read.x,b.read.x\n1.0,2,\n"),
            "file:1: has columns of several addresses");
  EXPECT_EQ(refusal<Point2D>("time_s,a.read.z\n1.0,2\n"), "file:1: has no column of point2d/1 ");
  EXPECT_EQ(refusal<Point2D>("time_s,a.read.x\n1.0,2\n1.0\n"),
            "file:3: has another number of cells than the header");
  EXPECT_EQ(refusal<Point2D>("time_s,a.read.x\nsoon,2\n"), "file:2: has no time");
  EXPECT_EQ(refusal<Point2D>("time_s,a.read.x\n1.0,\"2\n"),
            "file:2: has a quote that is not closed");
  EXPECT_EQ(refusal<Point2D>("time_s,a.read.x\n"), "file:1: has no value of this address");
}

}  // namespace
