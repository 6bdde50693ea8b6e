// SPDX-License-Identifier: LGPL-3.0-or-later
/// The graph of resources that call other resources, so that a thread holds the locks of both.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <mauve/detail/binding.h>
#include <mauve/result.h>

namespace mauve {

class Architecture;
class ResourceBase;

class ResourceGraph {
 public:
  /// Begins with all resources as they are connected now.
  explicit ResourceGraph(const Architecture& architecture);
  /// Gives the resource these connections, in place of those that it had.
  void put(const ResourceBase& resource, const Bindings& bindings);
  void connect(const ResourceBase& from, const ResourceBase& into);
  void remove(const ResourceBase& resource);

  /// Refused when resources form a cycle (two callers would wait for each other for ever), or nest
  /// deeper than a job can hold. The error names one of those that were put or connected last,
  /// where it can.
  [[nodiscard]] Status check() const;

 private:
  using Ways = std::vector<const ResourceBase*>;
  class Walk;

  void let_begin(const ResourceBase& resource);

  std::map<const ResourceBase*, Ways> ways_;
  Ways order_;  ///< in which they are looked at
};

}  // namespace mauve
