// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/book.h"

#include <cmath>
#include <iostream>
#include <numeric>

#include "bench/support/report.h"
#include "bench/support/table.h"

namespace bench {
namespace {

std::string joined(const Row& row, const std::string& between) {
  std::string text;
  for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : between) + row[i];
  return text;
}

/// For a file of comma separated values, without the emphasis of Markdown.
Row quoted(Row row) {
  for (std::string& cell : row) {
    std::erase(cell, '*');
    if (cell.find(',') != std::string::npos) cell = '"' + cell + '"';
  }
  return row;
}

}  // namespace

Statistics statistics(std::vector<double> samples) {
  Statistics result;
  result.count = samples.size();
  if (samples.empty()) return result;
  const auto count = static_cast<double>(samples.size());
  result.mean = std::accumulate(samples.begin(), samples.end(), 0.0) / count;
  double squares = 0;
  for (const double sample : samples) squares += (sample - result.mean) * (sample - result.mean);
  result.deviation = samples.size() < 2 ? 0 : std::sqrt(squares / (count - 1));
  result.least = percentile(samples, 0);
  result.middle = median(samples);
  result.p99 = percentile(samples, 99);
  result.most = percentile(std::move(samples), 100);
  return result;
}

Book::Book(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) return;
  std::filesystem::create_directories(folder_);
  report_.open(folder_ / "report.md");
}

void Book::line(const std::string& text) {
  std::cout << text << "\n" << std::flush;
  if (report_.is_open()) report_ << text << "\n" << std::flush;
}

void Book::text(const std::string& markdown) {
  line(markdown);
  line("");
}

void Book::table(const std::string& title, const Row& head, const std::vector<Row>& rows) {
  line("### " + title + "\n");
  line("| " + joined(head, " | ") + " |");
  line("|---|" + joined(Row(head.size() - 1, "---:"), "|") + "|");
  for (const Row& row : rows) line("| " + joined(row, " | ") + " |");
  line("");
}

void Book::csv(const std::string& name, const Row& head, const std::vector<Row>& rows) const {
  if (folder_.empty()) return;
  std::ofstream file(folder_ / (name + ".csv"));
  file << joined(quoted(head), ",") << "\n";
  for (const Row& row : rows) file << joined(quoted(row), ",") << "\n";
}

void Book::goal(const std::string& what, const std::string& target, const std::string& measured,
                bool met) {
  goals_.push_back({what, target, measured, met ? "met" : "MISSED"});
}

void Book::goals() {
  table("Goals", {"figure", "goal", "measured", ""}, goals_);
  csv("goals", {"figure", "goal", "measured", "verdict"}, goals_);
}

std::string ms(double value) { return shown(value, 3); }
std::string ns(double value) { return shown(value, value < 100 ? 1 : 0); }

}  // namespace bench
