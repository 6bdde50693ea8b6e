// SPDX-License-Identifier: LGPL-3.0-or-later
/// RingBuffer: a bounded queue of one type, with services `read` (oldest first) and `write`.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>

#include <mauve/host/resource.h>

namespace mauve {

struct DataType;

/// Type "ring_buffer" of the architecture file. A read takes the oldest item (`no_data` when
/// empty); a write to a full buffer drops the oldest item and counts it (`core.dropped`).
class RingBufferBase : public ResourceBase {
 public:
  static constexpr std::int64_t kCapacity = 64;  ///< items, unless core.capacity is set

  /// `core.capacity` is a property (default 64 items).
  RingBufferBase(std::string name, const DataType& data, std::shared_ptr<void> library = nullptr);

  /// For read ports.
  [[nodiscard]] ServiceBase& read_service() const { return *find_service("read"); }
  /// For write ports.
  [[nodiscard]] ServiceBase& write_service() const { return *find_service("write"); }
};

/// A queue in code, as a member of an Architecture: each item is read once. In a file it is the
/// type "ring_buffer". Readers and writers take the resource lock.
/// @snippet api_examples.cpp RingBuffer
template <typename T>
class RingBuffer final : public RingBufferBase {
  static_assert(std::is_trivially_copyable_v<T>,
                "mauve: exchanged data has fixed size: no heap inside");

 public:
  RingBuffer(Architecture& architecture, std::string name);  ///< joins the architecture
};

}  // namespace mauve
