// SPDX-License-Identifier: LGPL-3.0-or-later
/// Capsule: data that a core hands over, and the other types it can be made from.
#pragma once

#include <vector>

#include <mauve/type.h>

namespace mauve {

class ConvertsBase;

/// The common base class of states and slow states.
class Capsule {
 public:
  Capsule(const Capsule&) = delete;
  Capsule& operator=(const Capsule&) = delete;

  [[nodiscard]] const DataType& type() const { return type_; }
  /// Same name, revision and layout: goes from one core to the other as it is.
  [[nodiscard]] bool fits(const Capsule& other) const { return same_type(type_, other.type_); }
  /// The converter from another type into this one; null: the core has none.
  [[nodiscard]] const ConvertsBase* converter_from(const DataType& other) const;

 protected:
  explicit Capsule(const DataType& type) : type_(type) {}
  virtual ~Capsule() = default;

 private:
  friend class ConvertsBase;

  const DataType& type_;
  std::vector<const ConvertsBase*> converters_;
};

}  // namespace mauve
