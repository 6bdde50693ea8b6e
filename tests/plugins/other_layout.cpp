// SPDX-License-Identifier: LGPL-3.0-or-later
/// A data type with the name of good's, but another layout.
#include <string_view>
#include <tuple>

#include <mauve/plugin.h>

namespace zoo {
struct Numbers {
  double value = 0;
  double other = 0;
};
}  // namespace zoo

template <>
struct mauve::Described<zoo::Numbers> {
  static constexpr std::string_view name = "zoo_number/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("value", &zoo::Numbers::value),
                      mauve::field("other", &zoo::Numbers::other)};
  }
};

MAUVE_PLUGIN(plugin) { plugin.type<zoo::Numbers>(); }
