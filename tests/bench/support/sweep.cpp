// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/sweep.h"

#include <cmath>
#include <numeric>

#include "bench/support/report.h"
#include "bench/support/table.h"

namespace bench {
namespace {

/// Three digits that say something.
std::string brief(double value) {
  const double size = std::abs(value);
  if (size == 0 || size >= 100) return shown(value, 0);
  return shown(value, std::min(6, 2 - static_cast<int>(std::floor(std::log10(size)))));
}

}  // namespace

Line fit(const std::vector<std::pair<double, double>>& points) {
  const auto count = static_cast<double>(points.size());
  if (points.size() < 2) return {};
  double mean_x = 0;
  double mean_y = 0;
  for (const auto& [x, y] : points) mean_x += x / count, mean_y += y / count;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const auto& [x, y] : points) {
    xx += (x - mean_x) * (x - mean_x);
    xy += (x - mean_x) * (y - mean_y);
    yy += (y - mean_y) * (y - mean_y);
  }
  if (xx == 0) return {};
  const double slope = xy / xx;
  return {slope, mean_y - slope * mean_x, yy == 0 ? 1 : xy * xy / (xx * yy)};
}

void Sweep::add(double x, const std::vector<double>& values) {
  auto& columns = rounds_[x];
  columns.resize(columns_.size());
  for (std::size_t i = 0; i < columns_.size(); ++i) columns[i].push_back(values.at(i));
}

double Sweep::value(double x, std::size_t column) const {
  const std::vector<double>& all = rounds_.at(x)[column];
  return columns_[column].total ? std::accumulate(all.begin(), all.end(), 0.0) : median(all);
}

Line Sweep::line(std::size_t column) const {
  std::vector<std::pair<double, double>> points;
  for (const auto& [x, all] : rounds_) points.emplace_back(x, value(x, column));
  return fit(points);
}

void Sweep::print(Book& book) const {
  Row head{grows_};
  for (const Column& column : columns_) head.push_back(column.head);
  std::vector<Row> rows;
  for (const auto& [x, all] : rounds_) {
    Row& row = rows.emplace_back(Row{brief(x)});
    for (std::size_t i = 0; i < columns_.size(); ++i) row.push_back(brief(value(x, i)));
  }
  book.csv(name_, head, rows);
  Row slopes{"**slope**"};
  Row fits{"r2"};
  std::vector<Row> kept;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Line found = line(i);
    const Column& column = columns_[i];
    const bool none = column.unit.empty() || rounds_.size() < 2;
    slopes.push_back(none ? "" : brief(found.slope) + " " + column.unit);
    fits.push_back(none ? "" : shown(found.r2, 3));
    if (none) continue;
    kept.push_back(
        {column.head, brief(found.slope), column.unit, brief(found.at_zero), shown(found.r2, 3)});
  }
  book.csv(name_ + "_slope", {"figure", "slope", "unit", "at_zero", "r2"}, kept);
  rows.push_back(slopes);
  rows.push_back(fits);
  book.table(title_, head, rows);
}

}  // namespace bench
