// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/name.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace mauve {
namespace {

// Nobody mistypes more than this; it also bounds the work for hostile input.
constexpr std::size_t kLongestWord = 128;

using Row = std::array<std::size_t, kLongestWord + 1>;

/// Optimal string alignment distance of two texts of at most kLongestWord characters.
std::size_t distance(std::string_view a, std::string_view b) {
  Row before_last{};
  Row last{};
  Row current{};
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({last[j] + 1, current[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) current[j] = std::min(current[j], before_last[j - 2] + 1);
    }
    before_last = last;
    last = current;
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view wanted, const std::vector<std::string>& known) {
  if (wanted.empty() || wanted.size() > kLongestWord) return {};
  std::size_t best = std::max<std::size_t>(1, wanted.size() / 3) + 1;
  const std::string* nearest = nullptr;
  const std::string* begun = nullptr;
  for (const std::string& name : known) {
    if (name.size() > kLongestWord) continue;
    if (begun == nullptr && wanted.size() >= 3 && name.starts_with(wanted)) begun = &name;
    const std::size_t length_gap =
        std::max(name.size(), wanted.size()) - std::min(name.size(), wanted.size());
    if (length_gap >= best) continue;
    const std::size_t edits = distance(wanted, name);
    if (edits >= best) continue;
    best = edits;
    nearest = &name;
  }
  if (nearest != nullptr) return *nearest;
  return begun != nullptr ? *begun : std::string{};
}

std::string did_you_mean(std::string_view wanted, const std::vector<std::string>& known,
                         std::string_view quote) {
  const std::string nearest = nearest_name(wanted, known);
  if (nearest.empty()) return {};
  return std::string("did you mean ").append(quote).append(nearest).append(quote) + "?";
}

std::string known_names(std::string_view wanted, const std::vector<std::string>& known) {
  constexpr std::size_t kFew = 12;
  std::string hint = did_you_mean(wanted, known);
  if (!hint.empty() || known.empty()) return hint;
  for (std::size_t i = 0; i < std::min(kFew, known.size()); ++i) {
    hint += (i == 0 ? "" : ", ") + known[i];
  }
  if (known.size() > kFew) hint += " and " + std::to_string(known.size() - kFew) + " more";
  return (known.size() == 1 ? "there is " : "there are ") + hint;
}

}  // namespace mauve
