// SPDX-License-Identifier: LGPL-3.0-or-later
/// Maps as robots keep them (ROS map_server): a YAML file with image, resolution, origin, negate,
/// occupied_thresh, free_thresh and mode. Beside it is a PGM image (P5 or P2) whose first row is
/// the top of the map. A level v is p = (255 - v) / 255, with `negate` v / 255; p above
/// occupied_thresh is occupied (100), below free_thresh free (0), else unknown (-1). Modes other
/// than trinary, and images with more than 8 bits, are refused.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/result.h>

#include "../types/grid.h"

namespace navigation {

using rover::OccupancyGrid;

/// The content of the YAML file.
struct MapDescription {
  std::string image;  ///< as written; relative to the folder of the YAML file
  double resolution = 0.0;
  rover::Pose2D origin;
  bool negate = false;
  double occupied_thresh = 0.65;
  double free_thresh = 0.196;
};

struct MapImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> levels;  ///< 0 to 255, the top row first
};

/// Reads both files. An error names the file, the line and the problem. `time` of the grid stays.
/// [factory]
[[nodiscard]] mauve::Status load_map(const std::string& file, OccupancyGrid& into);
/// The same; `frees_unknown`: see is_unknown_freed().
[[nodiscard]] mauve::Status load_map(const std::string& file, OccupancyGrid& into,
                                     bool& frees_unknown);
/// Writes FILE.yaml and FILE.pgm, if `file` is "FILE.yaml". Cells of 0, 100 and -1 are read again
/// as they were; of others those below 20 become free, those above 65 occupied. [factory]
[[nodiscard]] mauve::Status save_map(const OccupancyGrid& grid, const std::string& file);

/// Parts of load_map(); `name` stands for the file in errors. [any]
[[nodiscard]] mauve::Result<MapDescription> parse_description(std::string_view text,
                                                              const std::string& name);
[[nodiscard]] mauve::Result<MapImage> parse_pgm(std::string_view bytes, const std::string& name);
/// The image has cells of the level 205, by which map_saver means unknown, and free_thresh makes
/// them free, as in map_server.
[[nodiscard]] bool is_unknown_freed(const MapDescription& description, const MapImage& image);
/// The sizes fit: parse_pgm() refuses others.
void fill_grid(const MapDescription& description, const MapImage& image, OccupancyGrid& into);

}  // namespace navigation
