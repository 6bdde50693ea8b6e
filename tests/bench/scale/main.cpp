// SPDX-License-Identifier: LGPL-3.0-or-later
/// The growth of each cost with the size of the system:
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bench/scale/sweeps.h"
#include "bench/support/machine.h"
#include "bench/support/parts.h"

namespace bench::scale {
namespace {

using Sweeping = void (*)(Book&, const Options&);

/// Components first: children of a process without threads.
const std::vector<std::pair<std::string, Sweeping>> kSweeps{
    {"components", sweep_components},     {"cpus", sweep_cpus},   {"payload", sweep_payload},
    {"transactions", sweep_transactions}, {"ports", sweep_ports}, {"clients", sweep_clients}};

void run(int argc, char** argv) {
  std::vector<std::string> names;
  for (const auto& [name, sweep] : kSweeps) names.push_back(name);
  Parts parts = parse_parts(argc, argv, names);
  parts.options.rounds = parts.options.choose(3, 1);
  Book book(parts.folder);
  book.text("## scale");
  book.text(describe_machine());
  book.text("Medians of " + std::to_string(parts.options.rounds) +
            " rounds; releases missed and what was disturbed are sums. Slopes are straight lines "
            "with the least squares through all points.");
  for (const auto& [name, sweep] : kSweeps) {
    if (std::find(parts.names.begin(), parts.names.end(), name) != parts.names.end()) {
      sweep(book, parts.options);
    }
  }
}

}  // namespace
}  // namespace bench::scale

int main(int argc, char** argv) { bench::scale::run(argc, argv); }
