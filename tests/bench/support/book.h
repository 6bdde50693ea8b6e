// SPDX-License-Identifier: LGPL-3.0-or-later
/// Book: tables of one report, on standard output, and as files where asked.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace bench {

/// Of samples in one unit.
struct Statistics {
  std::size_t count = 0;
  double mean = 0;
  double deviation = 0;
  double least = 0;
  double middle = 0;
  double p99 = 0;
  double most = 0;
};
[[nodiscard]] Statistics statistics(std::vector<double> samples);

using Row = std::vector<std::string>;

class Book {
 public:
  /// Empty: no files.
  explicit Book(std::filesystem::path folder);

  void text(const std::string& markdown);
  void table(const std::string& title, const Row& head, const std::vector<Row>& rows);
  /// `name`.csv
  void csv(const std::string& name, const Row& head, const std::vector<Row>& rows) const;
  /// Kept for the table at the end.
  void goal(const std::string& what, const std::string& target, const std::string& measured,
            bool met);
  void goals();

 private:
  void line(const std::string& text);

  std::filesystem::path folder_;
  std::ofstream report_;
  std::vector<Row> goals_;
};

/// Three decimals, as in the paper.
[[nodiscard]] std::string ms(double value);
[[nodiscard]] std::string ns(double value);

}  // namespace bench
