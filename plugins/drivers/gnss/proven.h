// SPDX-License-Identifier: LGPL-3.0-or-later
/// The kinds of frames that a line has proven to seal with a checksum.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace drivers {

/// Two undamaged frames of a kind in a row prove it; a single one may be right by accident. It
/// keeps the kinds heard last, by their whole names. All of it is [rt].
template <typename Name, std::size_t kMost>
class Proven {
 public:
  /// A frame of this name had a right checksum.
  void right(const Name& name) {
    auto at = find(name);
    if (at == kinds_.end()) {
      at = kinds_.end() - 1;
      *at = {name, 0};
    }
    if (at->right < kProof) ++at->right;
    std::rotate(kinds_.begin(), at, at + 1);
  }
  /// One had a wrong checksum: true, when that is damage.
  bool wrong(const Name& name) {
    const auto at = find(name);
    if (at == kinds_.end()) return false;
    const bool damage = at->right == kProof;
    at->right = 0;
    return damage;
  }

 private:
  static constexpr std::uint8_t kProof = 2;

  struct Kind {
    Name name{};
    std::uint8_t right = 0;  // in a row
  };
  using Kinds = std::array<Kind, kMost>;

  typename Kinds::iterator find(const Name& name) {
    return std::find_if(kinds_.begin(), kinds_.end(),
                        [&](const Kind& kind) { return kind.name == name; });
  }

  Kinds kinds_{};  // the one heard last is the first
};

}  // namespace drivers
