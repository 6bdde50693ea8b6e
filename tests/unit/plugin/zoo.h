// SPDX-License-Identifier: LGPL-3.0-or-later
/// The plugins of tests/plugins, put where a test wants them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/load/catalog.h"
#include "plugins/number.h"
#include "support/temp_dir.h"

namespace mauve::plugin::test {

inline std::filesystem::path zoo_file(std::string_view file) {
  return std::filesystem::path(MAUVE_ZOO) / file;
}

/// A plugin directory of its own.
class PluginDir {
 public:
  /// Puts a copy of "1/good.so" of the zoo there as "good.so", by rename as a package manager does.
  void put(std::string_view from, std::string_view as) const {
    const auto fresh = folder_ / "fresh";
    std::filesystem::copy_file(zoo_file(from), fresh,
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::rename(fresh, folder_ / as);
  }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const {
    return folder_ / name;
  }
  [[nodiscard]] std::vector<std::string> list() const { return {folder_.path().string()}; }

 private:
  mauve::test::TempDir folder_;
};

/// Calls the code of a core of the zoo.
inline int number(CoreBase& core) { return static_cast<zoo::NumberCore&>(core).number(); }

inline std::shared_ptr<CoreBase> make_core(const Catalog& catalog, std::string_view name) {
  const Result<CoreType> type = catalog.core(name);
  return type ? type->make() : nullptr;
}

}  // namespace mauve::plugin::test
