// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/supervision.h"

#include <algorithm>

namespace mauve::rules {

std::string_view to_string(Action action) {
  constexpr std::string_view kTexts[] = {"disconnect", "connect", "swap", "set", "stop", "start"};
  return kTexts[static_cast<std::size_t>(action)];
}

std::string_view to_string(Unknown answer) { return answer == Unknown::fire ? "fire" : "hold"; }

std::string_view element_of(const Step& step) {
  return std::string_view(step.subject).substr(0, step.subject.find('.'));
}

const Steps* Supervision::find(std::string_view transaction) const {
  const auto found = std::find_if(transactions.begin(), transactions.end(),
                                  [&](const auto& one) { return one.first == transaction; });
  return found == transactions.end() ? nullptr : &found->second;
}

bool Supervision::permits(std::string_view component, std::string_view transaction) const {
  const auto found = may_request.find(component);
  return found != may_request.end() &&
         std::find(found->second.begin(), found->second.end(), transaction) != found->second.end();
}

}  // namespace mauve::rules
