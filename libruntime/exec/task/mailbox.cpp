// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/mailbox.h"

#include "exec/update/task_update.h"

namespace mauve::exec {

Mailbox::~Mailbox() {
  delete back_.load();
  delete standby_.load();
  static_cast<void>(reclaim());
}

bool Mailbox::stand_by(TaskUpdate& standby) {
  TaskUpdate* none = nullptr;
  return standby_.compare_exchange_strong(none, &standby, std::memory_order_acq_rel);
}

std::vector<std::unique_ptr<TaskUpdate>> Mailbox::reclaim() {
  std::vector<std::unique_ptr<TaskUpdate>> all;
  TaskUpdate* next = unused_.exchange(nullptr, std::memory_order_acquire);
  while (next != nullptr) {
    all.emplace_back(next);
    next = next->older;
  }
  return all;
}

MAUVE_RUNS_AT_A_SWAP TaskUpdate* Mailbox::exchange_back(std::unique_ptr<TaskUpdate>&& back) {
  if (back == nullptr && this->back() == nullptr) return nullptr;
  return back_.exchange(back.release(), std::memory_order_acq_rel);
}

MAUVE_RUNS_AT_A_SWAP TaskUpdate* Mailbox::exchange_standby(std::unique_ptr<TaskUpdate>&& standby) {
  return standby_.exchange(standby.release(), std::memory_order_acq_rel);
}

MAUVE_RUNS_AT_A_SWAP void Mailbox::retire(TaskUpdate& unused) {
  TaskUpdate* top = unused_.load(std::memory_order_relaxed);
  do {
    unused.older = top;
  } while (!unused_.compare_exchange_weak(top, &unused, std::memory_order_acq_rel));
}

}  // namespace mauve::exec
