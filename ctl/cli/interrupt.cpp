// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/interrupt.h"

namespace mauve::ctl {
namespace {

// The signal handler has nothing else to look at.
volatile sig_atomic_t g_enough = 0;

extern "C" void enough(int) { g_enough = 1; }

}  // namespace

Interrupt::Interrupt() {
  g_enough = 0;
  struct sigaction action {};
  action.sa_handler = enough;
  sigaction(SIGINT, nullptr, &on_interrupt_);
  if (on_interrupt_.sa_handler != SIG_IGN) sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, &on_end_);
}

Interrupt::~Interrupt() {
  sigaction(SIGINT, &on_interrupt_, nullptr);
  sigaction(SIGTERM, &on_end_, nullptr);
}

bool Interrupt::came() const { return g_enough != 0; }

}  // namespace mauve::ctl
