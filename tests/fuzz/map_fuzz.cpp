// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes, a description up to the first NUL and then an image: each is refused with a reason, or
// becomes a grid whose size is that of its cells.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "../../plugins/navigation/grid_frame.h"
#include "../../plugins/navigation/map_file.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(all.find('\0'), size);
  const auto description = navigation::parse_description(all.substr(0, end), "map.yaml");
  const auto image = navigation::parse_pgm(all.substr(std::min(end + 1, size)), "map.pgm");
  require(description.has_value() || !description.error().message.empty());
  require(image.has_value() || !image.error().message.empty());
  if (!description || !image) return 0;
  static const auto grid = std::make_unique<navigation::OccupancyGrid>();
  navigation::fill_grid(*description, *image, *grid);
  require(navigation::Frame::of(*grid).has_value());
  return 0;
}
