// SPDX-License-Identifier: LGPL-3.0-or-later
/// Sweep: costs while one thing grows. A table of it, and with which slope each cost grows.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/book.h"

namespace bench {

/// The straight line with the least squares.
struct Line {
  double slope = 0;
  double at_zero = 0;
  double r2 = 0;  ///< how much of the variance it explains; 1 where there are two points only
};
[[nodiscard]] Line fit(const std::vector<std::pair<double, double>>& points);

class Sweep {
 public:
  struct Column {
    std::string head;
    std::string unit;    ///< of the slope: "us a component"; empty: has none
    bool total = false;  ///< the sum of all rounds, otherwise their median
  };

  /// `name` is that of its files; `grows` heads the first column.
  Sweep(std::string name, std::string title, std::string grows, std::vector<Column> columns)
      : name_(std::move(name)),
        title_(std::move(title)),
        grows_(std::move(grows)),
        columns_(std::move(columns)) {}

  /// The values that one round measured at `x`, a value a column.
  void add(double x, const std::vector<double>& values);
  /// Table and files NAME.csv and NAME_slope.csv.
  void print(Book& book) const;

 private:
  [[nodiscard]] double value(double x, std::size_t column) const;
  [[nodiscard]] Line line(std::size_t column) const;

  std::string name_;
  std::string title_;
  std::string grows_;
  std::vector<Column> columns_;
  std::map<double, std::vector<std::vector<double>>> rounds_;  // by x
};

}  // namespace bench
