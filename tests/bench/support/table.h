// SPDX-License-Identifier: LGPL-3.0-or-later
/// Table: figures that more than a name distinguishes, and are the same on every machine.
#pragma once

#include <cstdio>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/report.h"

namespace bench {

class Table {
 public:
  using Row = std::vector<std::string>;

  Table(std::string name, std::string text, Row head)
      : name_(std::move(name)), text_(std::move(text)), head_(std::move(head)) {}

  void add(Row row) { rows_.push_back(std::move(row)); }

  void print(const Options& options) const {
    if (options.csv) {
      line("bench,", head_, ",", "");
      for (const Row& row : rows_) line("\"" + name_ + "\",", row, ",", "");
      return;
    }
    std::cout << "## " << name_ << "\n\n" << text_ << "\n\n";
    line("| ", head_, " | ", " |");
    line("|", Row(head_.size(), "---"), "|", "|");
    for (const Row& row : rows_) line("| ", row, " | ", " |");
    std::cout << "\n";
  }

 private:
  static void line(const std::string& begin, const Row& row, const char* between, const char* end) {
    std::cout << begin;
    for (std::size_t i = 0; i < row.size(); ++i) std::cout << (i == 0 ? "" : between) << row[i];
    std::cout << end << "\n";
  }

  std::string name_;
  std::string text_;
  Row head_;
  std::vector<Row> rows_;
};

[[nodiscard]] inline std::string shown(double value, int digits = 2) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

}  // namespace bench
