// SPDX-License-Identifier: LGPL-3.0-or-later
/// SharedData: the latest value of one type, with services `read` and `write`.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>

#include <mauve/host/resource.h>

namespace mauve {

struct DataType;

/// Type "shared_data" of the architecture file. Reads are wait-free for the first readers
/// connected, and writes for the first writer connected; further readers and writers acquire the
/// resource's lock. One place of the readers is the administrator's. It keeps 2 n + 5 values for n
/// places: 21, and of a large value 9.
class SharedDataBase : public ResourceBase {
 public:
  static constexpr unsigned kReaders = 8;  ///< places of readers that never wait
  /// The places for a value of more than kLarge bytes, such as a map.
  static constexpr unsigned kReadersOfLarge = 2;
  static constexpr std::size_t kLarge = 256UL * 1024UL;  ///< bytes

  /// Readers get `initial` before the first write; null: no data.
  SharedDataBase(std::string name, const DataType& data, const void* initial = nullptr,
                 std::shared_ptr<void> library = nullptr);

  /// For read ports.
  [[nodiscard]] ServiceBase& read_service() const { return *find_service("read"); }
  /// For write ports.
  [[nodiscard]] ServiceBase& write_service() const { return *find_service("write"); }
};

/// The latest value of one type, as a member of an Architecture. In a file it is the type
/// "shared_data".
/// @snippet api_examples.cpp SharedData
template <typename T>
class SharedData final : public SharedDataBase {
  static_assert(std::is_trivially_copyable_v<T>,
                "mauve: exchanged data has fixed size: no heap inside");

 public:
  SharedData(Architecture& architecture, std::string name);  ///< no data at first
  /// Readers get `initial` before the first write.
  SharedData(Architecture& architecture, std::string name, const T& initial);
};

}  // namespace mauve
