// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/element/with_library.h"

#include <memory>
#include <utility>

namespace mauve {

std::shared_ptr<void> with_library(std::shared_ptr<void> library, std::shared_ptr<void> object) {
  struct Kept {
    std::shared_ptr<void> library;
    std::shared_ptr<void> object;
  };
  void* const address = object.get();
  auto kept = std::make_shared<Kept>(Kept{std::move(library), std::move(object)});
  return {std::move(kept), address};
}

}  // namespace mauve
