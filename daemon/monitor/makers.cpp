// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/makers.h"

#include <utility>

namespace mauve::daemon {

void Makers::remember(std::uint64_t generation, Maker maker) {
  makers_.insert_or_assign(generation, std::move(maker));
  if (makers_.size() > kMost) {
    makers_.erase(makers_.begin());
  }
}

std::vector<std::size_t> Makers::forget(const std::vector<std::uint64_t>& generations,
                                        std::uint64_t adoption) {
  std::vector<std::size_t> rules;
  for (const auto generation : generations) {
    const auto made = makers_.extract(generation);
    if (made && made.mapped().rule && made.mapped().adoption == adoption) {
      rules.push_back(*made.mapped().rule);
    }
  }
  return rules;
}

std::vector<std::string> Makers::notes_on(const std::vector<std::uint64_t>& generations,
                                          std::uint64_t adoption) const {
  std::vector<std::string> notes;
  for (const auto generation : generations) {
    const auto made = makers_.find(generation);
    if (made == makers_.end()) {
      continue;
    }
    const auto& [by, rule, of] = made->second;
    notes.push_back(
        "generation " + std::to_string(generation) +
        (by.starts_with("by") ? " was made " : " was ") + by +
        (rule && of == adoption ? ", which fires again while its condition holds" : ""));
  }
  return notes;
}

}  // namespace mauve::daemon
