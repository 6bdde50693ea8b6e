// SPDX-License-Identifier: LGPL-3.0-or-later
/// The experiments of the paper's section 4.
#pragma once

#include <string>

#include "bench/support/book.h"
#include "bench/support/report.h"

namespace bench::paper {

struct Setting {
  Options options;
  int cpu = 0;
  std::string ros;     ///< the program; empty: not measured
  std::string orocos;  ///< the same
};

/// Tables 2 and 3.
void measure_execution(Book& book, const Setting& setting);
/// Table 4 and Fig. 9.
void measure_reconfiguration(Book& book, const Setting& setting);
/// Tables 5 and 6.
void measure_exchange(Book& book, const Setting& setting);

}  // namespace bench::paper
