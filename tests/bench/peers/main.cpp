// SPDX-License-Identifier: LGPL-3.0-or-later
/// The same exchange by mauve and by its peers, in turn in one process:
///   peers [--smoke] [--out FOLDER] [100 | 1000 | 10000 | 100000]...    bytes of the value
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/peers/contenders.h"
#include "bench/peers/measure.h"
#include "bench/support/book.h"
#include "bench/support/checked.h"
#include "bench/support/parts.h"

namespace bench::peers {
namespace {

/// Of one contender and one size; each figure has one entry for each round.
struct Results {
  std::vector<double> exchange;  ///< median write and median read together, ns
  std::vector<double> call;      ///< the longest call, ns
  std::vector<double> step;      ///< median step, us
  std::vector<double> last;      ///< the longest step, us
  std::size_t read_jobs = 0;
  std::size_t arrived = 0;

  void add(const Round& round) {
    exchange.push_back(median(round.writes) + median(round.reads));
    call.push_back(std::max(percentile(round.writes, 100), percentile(round.reads, 100)));
    step.push_back(median(round.steps));
    last.push_back(percentile(round.steps, 100));
    read_jobs += round.read_jobs;
    arrived += round.arrived;
  }
};

/// A table of the report: which entries it shows, and whether its figure is their maximum.
struct Figure {
  std::string name;
  std::string title;
  std::vector<double> Results::*entries;
  bool maximum;
};
const std::vector<Figure> kFigures{
    {"exchange", "One write and one read, median, ns", &Results::exchange, false},
    {"call", "The longest write or read of all, ns", &Results::call, true},
    {"step", "From a release of the writer until its value is written, median, us", &Results::step,
     false},
    {"last", "The longest of these, us", &Results::last, true}};

/// The figure, and its ratio to that of the raw loop. The ratio of a median is the median of the
/// ratios of the rounds.
struct Value {
  double value;
  double ratio;
};
Value value_of(const Figure& figure, const Results& ours, const Results& raw) {
  const std::vector<double>& entries = ours.*figure.entries;
  const std::vector<double>& floor = raw.*figure.entries;
  if (figure.maximum) {
    const double most = percentile(entries, 100);
    return {most, most / percentile(floor, 100)};
  }
  std::vector<double> ratios;
  for (std::size_t i = 0; i < entries.size(); ++i) ratios.push_back(entries[i] / floor[i]);
  return {median(entries), median(ratios)};
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 10 ? "%.2f" : value < 100 ? "%.1f" : "%.0f", value);
  return text;
}

/// Cells of one width in each column, so that a terminal shows the table as readably as a page.
void align(Row& head, std::vector<Row>& rows) {
  for (std::size_t column = 0; column < head.size(); ++column) {
    std::size_t width = head[column].size();
    for (const Row& row : rows) width = std::max(width, row[column].size());
    head[column].resize(width, ' ');
    for (Row& row : rows) {
      const std::string space(width - row[column].size(), ' ');
      row[column] = column == 0 ? row[column] + space : space + row[column];
    }
  }
}

class Comparison {
 public:
  Comparison(const Parts& parts, std::vector<Contender> contenders)
      : parts_(parts), contenders_(std::move(contenders)) {
    for (const std::string& name : parts_.names) sizes_.push_back(std::stoul(name));
    results_.resize(sizes_.size(), std::vector<Results>(contenders_.size()));
  }

  void measure() {
    const int cpu = mauve::rt::usable_cpus().back();
    const Duration time = std::chrono::milliseconds(parts_.options.choose(300, 60));
    const auto rounds = static_cast<std::size_t>(parts_.options.choose(7, 1));
    for (std::size_t round = 0; round < rounds; ++round) {
      for (std::size_t size = 0; size < sizes_.size(); ++size) {
        for (std::size_t turn = 0; turn < contenders_.size(); ++turn) {
          const std::size_t i = (turn + round) % contenders_.size();
          results_[size][i].add(measure_round(contenders_[i], sizes_[size], cpu, time));
        }
      }
    }
  }

  void print(Book& book) const {
    std::vector<Row> all;
    for (const Figure& figure : kFigures) {
      Row head{"peer (ratio to the raw loop)"};
      for (const std::size_t size : sizes_) head.push_back(std::to_string(size) + " B");
      std::vector<Row> rows;
      for (std::size_t i = 0; i < contenders_.size(); ++i) {
        Row row{contenders_[i].name};
        for (std::size_t size = 0; size < sizes_.size(); ++size) {
          const Value value = value_of(figure, results_[size][i], results_[size][0]);
          row.push_back(number(value.value) + " (" + number(value.ratio) + ")");
          all.push_back({figure.name, contenders_[i].name, std::to_string(sizes_[size]),
                         number(value.value), number(value.ratio)});
        }
        rows.push_back(row);
      }
      align(head, rows);
      book.table(figure.title, head, rows);
    }
    book.csv("peers", {"figure", "peer", "bytes", "value", "ratio"}, all);
    print_arrived(book);
  }

 private:
  static Round measure_round(const Contender& contender, std::size_t size, int cpu, Duration time) {
    if (contender.make == nullptr) return measure_mauve(size, cpu, time);
    const auto peer = contender.make(size);
    must_hold(peer != nullptr, contender.name.c_str());
    return measure_peer(*peer, size, cpu, time);
  }

  void print_arrived(Book& book) const {
    std::string text = "Reads that found a new value:";
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
      std::size_t jobs = 0;
      std::size_t arrived = 0;
      for (const auto& of_size : results_) {
        jobs += of_size[i].read_jobs;
        arrived += of_size[i].arrived;
      }
      text += (i == 0 ? " " : ", ") + contenders_[i].name + " " + std::to_string(arrived) + " of " +
              std::to_string(jobs);
    }
    book.text(text + ".");
  }

  const Parts& parts_;
  std::vector<Contender> contenders_;
  std::vector<std::size_t> sizes_;
  std::vector<std::vector<Results>> results_;
};

void run(const Parts& parts) {
  Book book(parts.folder);
  book.text("## peers");
  book.text(describe_machine());
  std::vector<Contender> measured;
  for (const Contender& contender : contenders()) {
    if (contender.left_out.empty()) {
      measured.push_back(contender);
    } else {
      book.text("Left out: " + contender.name + ". " + contender.left_out);
    }
  }
  if (fifo_or_none(kPriority) == 0) book.text("Without SCHED_FIFO: ordinary threads are measured.");
  Comparison comparison(parts, measured);
  comparison.measure();
  comparison.print(book);
}

}  // namespace
}  // namespace bench::peers

int main(int argc, char** argv) {
  std::vector<std::string> sizes;
  for (const std::size_t size : bench::peers::kSizes) sizes.push_back(std::to_string(size));
  bench::peers::run(bench::parse_parts(argc, argv, sizes));
}
