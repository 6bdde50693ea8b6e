// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/report.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "bench/support/machine.h"

namespace bench {
namespace {

std::string number(double value) {
  char text[32];
  const double size = value < 0 ? -value : value;
  const int digits = size >= 100 ? 0 : size >= 10 ? 1 : 2;
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

[[noreturn]] void usage(const char* program) {
  std::cerr << "usage: " << program << " [--csv] [--smoke] [--rounds N]\n";
  std::exit(2);
}

}  // namespace

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--csv") {
      options.csv = true;
    } else if (word == "--smoke") {
      options.smoke = true;
      options.rounds = 1;
    } else if (word == "--rounds" && i + 1 < argc && std::atoi(argv[i + 1]) > 0) {
      options.rounds = std::atoi(argv[++i]);
    } else {
      usage(argv[0]);
    }
  }
  return options;
}

double percentile(std::vector<double> samples, double percent) {
  if (samples.empty()) return 0;
  const auto last = static_cast<double>(samples.size() - 1);
  const auto at = static_cast<std::ptrdiff_t>(percent / 100 * last + 0.5);
  std::nth_element(samples.begin(), samples.begin() + at, samples.end());
  return samples[static_cast<std::size_t>(at)];
}

void Figure::add(double ours, double raw) {
  ours_.push_back(ours);
  raw_.push_back(raw);
  if (raw != 0) ratio_.push_back(ours / raw);
  above_.push_back(ours - raw);
}

std::string Figure::target() const {
  switch (target_.kind) {
    case Target::Kind::none:
      return "";
    case Target::Kind::at_most:
      return "<= " + number(target_.limit) + " " + unit_;
    case Target::Kind::above_raw:
      return "<= raw + " + number(target_.limit) + " " + unit_;
    case Target::Kind::times_raw:
      return "<= raw x " + number(target_.limit);
  }
  return "";
}

std::string Figure::verdict() const {
  switch (target_.kind) {
    case Target::Kind::none:
      return "";
    case Target::Kind::at_most:
      return median(ours_) <= target_.limit ? "met" : "MISSED";
    case Target::Kind::above_raw:
      return median(above_) <= target_.limit ? "met" : "MISSED";
    case Target::Kind::times_raw:
      return median(ratio_) <= target_.limit ? "met" : "MISSED";
  }
  return "";
}

std::string Figure::markdown() const {
  const bool compared = !raw_.empty();
  return "| " + name_ + " | " + (ratio_.empty() ? "" : number(median(ratio_))) + " | " +
         (compared ? number(median(above_)) : "") + " | " + number(median(ours_)) + " | " +
         (compared ? number(median(raw_)) : "") + " | " + unit_ + " | " + target() + " | " +
         verdict() + " |";
}

std::string Figure::csv(std::string_view bench) const {
  const bool compared = !raw_.empty();
  return std::string(bench) + ",\"" + name_ + "\"," +
         (ratio_.empty() ? "" : number(median(ratio_))) + "," +
         (compared ? number(median(above_)) : "") + "," + number(median(ours_)) + "," +
         (compared ? number(median(raw_)) : "") + "," + unit_ + "," + target() + "," + verdict() +
         "," + std::to_string(ours_.size());
}

Figure& Report::figure(std::string name, std::string unit, Target target) {
  return figures_.emplace_back(std::move(name), std::move(unit), target);
}

void Report::print() const {
  if (options_.csv) {
    std::cout << "bench,figure,ratio,above_raw,ours,raw,unit,target,verdict,rounds\n";
    for (const Figure& figure : figures_) std::cout << figure.csv(name_) << "\n";
    return;
  }
  std::cout << "## " << name_ << "\n\n" << text_ << "\n\n" << describe_machine() << "\n\n";
  std::cout << "Medians of " << options_.rounds << " rounds.\n\n"
            << "| figure | ours / raw | ours - raw | ours | raw | unit | target | |\n"
            << "|---|---:|---:|---:|---:|---|---|---|\n";
  for (const Figure& figure : figures_) std::cout << figure.markdown() << "\n";
  std::cout << "\n";
  for (const std::string& note : notes_) std::cout << "- " << note << "\n";
  if (!notes_.empty()) std::cout << "\n";
}

}  // namespace bench
