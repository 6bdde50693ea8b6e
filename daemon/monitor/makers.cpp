// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/makers.h"

#include <algorithm>
#include <utility>

namespace mauve::daemon {

void Makers::remember(std::uint64_t generation, Maker maker) {
  makers_.emplace(generation, std::move(maker));
  if (makers_.size() > kMost) {
    makers_.erase(makers_.begin());
  }
}

void Makers::rely(const std::vector<OpenProbation>& open, const rules::Steps& steps,
                  const Maker& maker) {
  for (const auto& one : open) {
    const auto concerns = [&one](const rules::Step& step) {
      const auto component = step.subject.substr(0, step.subject.find('.'));
      return std::ranges::find(one.components, component) != one.components.end();
    };
    if (!one.rolls_back && std::ranges::any_of(steps, concerns) &&
        !is_remembered(one.generations, maker)) {
      remember(one.generations.back(), maker);
    }
  }
}

bool Makers::is_remembered(const std::vector<std::uint64_t>& generations,
                           const Maker& maker) const {
  return std::ranges::any_of(generations, [&](std::uint64_t generation) {
    const auto [first, last] = makers_.equal_range(generation);
    return std::any_of(first, last, [&](const auto& made) {
      const auto& [by, rule, adoption] = made.second;
      const bool is_same_rule = rule && rule == maker.rule && adoption == maker.adoption;
      return is_same_rule || by == maker.by;
    });
  });
}

std::vector<std::size_t> Makers::forget(const std::vector<std::uint64_t>& generations,
                                        std::uint64_t adoption) {
  std::vector<std::size_t> rules;
  for (const auto generation : generations) {
    const auto [first, last] = makers_.equal_range(generation);
    for (auto made = first; made != last; ++made) {
      if (made->second.rule && made->second.adoption == adoption) {
        rules.push_back(*made->second.rule);
      }
    }
    makers_.erase(first, last);
  }
  return rules;
}

std::vector<std::string> Makers::notes_on(const std::vector<std::uint64_t>& generations,
                                          std::uint64_t adoption) const {
  std::vector<std::string> notes;
  for (const auto generation : generations) {
    const auto [first, last] = makers_.equal_range(generation);
    for (auto made = first; made != last; ++made) {
      const auto& [by, rule, of] = made->second;
      notes.push_back(
          "generation " + std::to_string(generation) +
          (by.starts_with("by") ? " was made " : " is ") + by +
          (rule && of == adoption ? ", which fires again while its condition holds" : ""));
    }
  }
  return notes;
}

}  // namespace mauve::daemon
