// SPDX-License-Identifier: LGPL-3.0-or-later
#include "supervision/makers.h"

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
      const auto& [by, rule] = made.second;
      return (rule && rule == maker.rule) || by == maker.by;
    });
  });
}

std::vector<rules::RuleId> Makers::forget(const std::vector<std::uint64_t>& generations) {
  std::vector<rules::RuleId> rules;
  for (const auto generation : generations) {
    const auto [first, last] = makers_.equal_range(generation);
    for (auto made = first; made != last; ++made) {
      if (made->second.rule) {
        rules.push_back(*made->second.rule);
      }
    }
    makers_.erase(first, last);
  }
  return rules;
}

std::vector<std::string> Makers::notes_on(
    const std::vector<std::uint64_t>& generations,
    const std::function<std::string(rules::RuleId)>& then) const {
  std::map<std::string, std::pair<std::string, const Maker*>> all;  // by their words
  for (const auto generation : generations) {
    const auto [first, last] = makers_.equal_range(generation);
    for (auto made = first; made != last; ++made) {
      auto& [numbers, maker] = all[made->second.by];
      numbers += (numbers.empty() ? "" : ", ") + std::to_string(generation);
      maker = &made->second;
    }
  }
  std::vector<std::string> notes;
  for (const auto& [by, made] : all) {
    const auto& [numbers, maker] = made;
    const bool one = numbers.find(',') == std::string::npos;
    const auto after = maker->rule ? then(*maker->rule) : std::string();
    notes.push_back((one ? "generation " : "generations ") + numbers +
                    (by.starts_with("by") ? one ? " was made " : " were made "
                     : one                ? " is "
                                          : " are ") +
                    by + (after.empty() ? "" : ", " + after));
  }
  return notes;
}

}  // namespace mauve::daemon
