// SPDX-License-Identifier: LGPL-3.0-or-later
/// SharedData of 1 B to 1 MB through ports, alone on a CPU, beside memcpy.
#include <memory>

#include "bench/scale/sweeps.h"
#include "bench/support/exchange.h"
#include "bench/support/sweep.h"

namespace bench::scale {
namespace {

template <std::size_t Size>
void measure(Sweep& sweep, const Options& options) {
  const auto ways = std::make_unique<Contenders<Size>>();
  const std::vector<Operation> operations{ways->write(), ways->read(), ways->copy()};
  const int times = Size < 5000 ? 1000 : Size < 500'000 ? 50 : 5;
  for (int round = 0; round < options.rounds; ++round) {
    sweep.add(static_cast<double>(Size) / 1000, alone(operations, times, options.choose(50, 5)));
  }
}

}  // namespace

void sweep_payload(Book& book, const Options& options) {
  Sweep sweep("payload", "Payload of SharedData through ports", "kB",
              {{"write, ns", "ns/kB"}, {"read, ns", "ns/kB"}, {"memcpy, ns", "ns/kB"}});
  measure<1>(sweep, options);
  measure<10>(sweep, options);
  measure<100>(sweep, options);
  measure<1000>(sweep, options);
  measure<10'000>(sweep, options);
  measure<100'000>(sweep, options);
  measure<1'000'000>(sweep, options);
  sweep.print(book);
  book.text("The slope is that of the largest: what does not fit into a cache costs more a kB.");
}

}  // namespace bench::scale
