// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/transaction.h"

#include <cstring>

namespace mauve::exec {
namespace {

/// The way back begins so much later, so that no member passes the instant unaware of it.
constexpr Duration kLeadOfWayBack = 200us;
constexpr int kAttempts = 6;

}  // namespace

std::string_view to_string(Cause cause) {
  switch (cause) {
    case Cause::threw:
      return "threw";
    case Cause::implausible:
      return "wrote a value that is not plausible";
    case Cause::over_budget:
      return "took longer than its budget";
    case Cause::overruns:
      return "overran too often";
    case Cause::crashed:
      return "crashed";
    case Cause::hung:
      return "did not return";
    case Cause::asked:
      return "asked";
  }
  return "unknown";
}

std::string_view word_of(Cause cause) {
  constexpr std::array<std::string_view, 7> kWords{
      "threw", "implausible", "over_budget", "overruns", "crashed", "hung", "asked"};
  return kWords.at(static_cast<std::size_t>(cause));
}

bool WayBack::set_off(const Clock& clock, Cause cause, const void* member, const char* text,
                      const void* inside) {
  if (!transaction_.claim(kBeingSetOff)) return false;
  Transaction* const newer = newer_.load();
  if (newer != nullptr &&
      newer->decide(Transaction::State::aborted) == Transaction::State::committed) {
    transaction_.put_off(kClosed);
    return false;
  }
  cause_ = cause;
  member_ = member;
  inside_ = inside;
  std::strncpy(text_.data(), text, text_.size() - 1);
  decide(clock);
  told_.store(true, std::memory_order_release);
  return true;
}

/// Whoever does this may be preempted at any point, until the instant has passed.
void WayBack::decide(const Clock& clock) {
  Duration lead = kLeadOfWayBack;
  for (int attempt = 0; attempt < kAttempts; ++attempt, lead *= 2) {
    const Instant instant = clock.now() + lead.count();
    transaction_.attempt(instant);
    const bool late = clock.now() >= instant - kDecisionMargin.count();
    const auto wanted = late ? Transaction::State::aborted : Transaction::State::committed;
    if (transaction_.decide(wanted) == Transaction::State::committed) return;
    transaction_.put_off(kBeingSetOff);
  }
  // It has to end. A member that passes the instant between these two goes back one job later.
  transaction_.attempt(kBeingSetOff, Transaction::State::committed);
  transaction_.put_off(clock.now() + lead.count());
}

void WayBack::give_way_to(std::shared_ptr<Transaction> newer) {
  newer_.store(newer.get());
  if (newer != nullptr) all_newer_.push_back(std::move(newer));
}

}  // namespace mauve::exec
