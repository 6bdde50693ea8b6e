// SPDX-License-Identifier: LGPL-3.0-or-later
/// Report: what a benchmark prints. Each figure is measured in rounds, ours and a raw loop's in
/// turn; medians over the rounds, ratios first. Nothing is asserted.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace bench {

/// From the command line: `NAME [--csv] [--smoke] [--rounds N]`.
struct Options {
  bool csv = false;    ///< comma separated values instead of Markdown
  bool smoke = false;  ///< a second: only to see that it runs
  int rounds = 5;

  /// `full`, or `brief` in a smoke run.
  [[nodiscard]] int choose(int full, int brief) const { return smoke ? brief : full; }
};
/// Ends the program with a usage text when it does not understand.
[[nodiscard]] Options parse(int argc, char** argv);

/// The promise for a figure.
struct Target {
  enum class Kind : unsigned char { none, at_most, above_raw, times_raw };
  Kind kind = Kind::none;
  double limit = 0;
};
inline Target at_most(double limit) { return {Target::Kind::at_most, limit}; }
/// Ours is at most raw + `limit`.
inline Target above_raw(double limit) { return {Target::Kind::above_raw, limit}; }
/// Ours is at most raw * `limit`.
inline Target times_raw(double limit) { return {Target::Kind::times_raw, limit}; }

/// One line of the table.
class Figure {
 public:
  Figure(std::string name, std::string unit, Target target)
      : name_(std::move(name)), unit_(std::move(unit)), target_(target) {}

  /// The result of one round.
  void add(double ours, double raw);
  /// Without a raw counterpart.
  void add(double ours) { ours_.push_back(ours); }

  [[nodiscard]] std::string markdown() const;
  [[nodiscard]] std::string csv(std::string_view bench) const;

 private:
  [[nodiscard]] std::string target() const;
  [[nodiscard]] std::string verdict() const;

  std::string name_;
  std::string unit_;
  Target target_;
  std::vector<double> ours_;
  std::vector<double> raw_;
  std::vector<double> ratio_;
  std::vector<double> above_;
};

class Report {
 public:
  Report(std::string name, std::string text, Options options)
      : name_(std::move(name)), text_(std::move(text)), options_(options) {}

  /// The reference stays valid.
  Figure& figure(std::string name, std::string unit, Target target = {});
  /// A sentence below the table.
  void note(std::string text) { notes_.push_back(std::move(text)); }
  void print() const;

 private:
  std::string name_;
  std::string text_;
  Options options_;
  std::deque<Figure> figures_;
  std::vector<std::string> notes_;
};

/// The value below which `percent` of the samples lie; 0 when there are none.
[[nodiscard]] double percentile(std::vector<double> samples, double percent);
[[nodiscard]] inline double median(std::vector<double> samples) {
  return percentile(std::move(samples), 50);
}

}  // namespace bench
