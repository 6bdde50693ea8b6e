// SPDX-License-Identifier: LGPL-3.0-or-later
/// One sweep a file: what grows is the name.
#pragma once

#include "bench/support/book.h"
#include "bench/support/report.h"

namespace bench::scale {

void sweep_components(Book& book, const Options& options);
void sweep_cpus(Book& book, const Options& options);
void sweep_payload(Book& book, const Options& options);
void sweep_transactions(Book& book, const Options& options);
void sweep_ports(Book& book, const Options& options);
void sweep_clients(Book& book, const Options& options);

}  // namespace bench::scale
