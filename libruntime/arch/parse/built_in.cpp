// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/built_in.h"

#include <utility>

#include "mauve/host/ring_buffer.h"
#include "mauve/host/shared_data.h"
#include "mauve/type.h"

namespace mauve::arch {

std::unique_ptr<ResourceBase> make_built_in(std::string_view type, std::string name,
                                            std::shared_ptr<const DataType> data) {
  const DataType& described = *data;
  std::shared_ptr<void> library = std::const_pointer_cast<DataType>(std::move(data));
  if (type == kRingBuffer) {
    return std::make_unique<RingBufferBase>(std::move(name), described, std::move(library));
  }
  return std::make_unique<SharedDataBase>(std::move(name), described, nullptr, std::move(library));
}

}  // namespace mauve::arch
