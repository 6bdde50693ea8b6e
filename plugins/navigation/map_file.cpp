// SPDX-License-Identifier: LGPL-3.0-or-later
#include "map_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <system_error>

#include <yaml-cpp/yaml.h>

#include "grid_frame.h"
#include "regular_file.h"

namespace navigation {
namespace {

using mauve::Errc;
using mauve::Error;
using mauve::refuse;
using mauve::Result;
using mauve::Status;

constexpr std::size_t kLongestDescription = 64UL * 1024UL;
constexpr std::size_t kLongestImage = 20UL * 1024UL * 1024UL;
constexpr std::uint8_t kFreeLevel = 254;
constexpr std::uint8_t kUnknownLevel = 205;
constexpr std::uint8_t kOccupiedLevel = 0;

/// One YAML file with its values; every refusal names the line.
class Reader {
 public:
  Reader(const YAML::Node& map, const std::string& name) : map_(map), name_(name) {}

  [[nodiscard]] bool has(const char* key) const { return map_[key].IsDefined(); }
  /// Of two values of one key it is not known which one is meant.
  [[nodiscard]] Status each_key_once() const {
    std::set<std::string> seen;
    for (const auto& entry : map_) {
      const YAML::Node& key = entry.first;
      if (!key.IsScalar() || seen.insert(key.Scalar()).second) continue;
      return wrong(key, key.Scalar().c_str(), "is there twice", "remove one of the two lines");
    }
    return mauve::ok();
  }

  Result<std::string> text(const char* key) const {
    const YAML::Node node = map_[key];
    if (!node.IsDefined()) return refuse(Errc::invalid_value, {}, name_ + ": says no " + key);
    if (!node.IsScalar()) return wrong(node, key, "must be one value");
    return node.Scalar();
  }
  Result<double> number(const char* key) const {
    const Result<std::string> found = text(key);
    if (!found) return found.error();
    return number(map_[key], key);
  }
  Result<double> number(const YAML::Node& node, const char* key) const {
    double value = 0.0;
    const std::string& text = node.Scalar();
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || at != end || !std::isfinite(value)) {
      return wrong(node, key, "must be a number");
    }
    return value;
  }
  Result<rover::Pose2D> pose(const char* key) const {
    const YAML::Node node = map_[key];
    if (!node.IsDefined()) return refuse(Errc::invalid_value, {}, name_ + ": says no " + key);
    if (!node.IsSequence() || node.size() != 3) return wrong(node, key, "must be [x, y, yaw]");
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (!node[i].IsScalar()) return wrong(node, key, "must be [x, y, yaw]");
      const Result<double> value = number(node[i], key);
      if (!value) return value.error();
      values[i] = *value;
    }
    return rover::Pose2D{values[0], values[1], values[2]};
  }
  [[nodiscard]] Error wrong(const char* key, const std::string& what,
                            const std::string& hint = {}) const {
    return wrong(map_[key], key, what, hint);
  }

 private:
  [[nodiscard]] Error wrong(const YAML::Node& node, const char* key, const std::string& what,
                            const std::string& hint = {}) const {
    return refuse(Errc::invalid_value, {},
                  name_ + ":" + std::to_string(node.Mark().line + 1) + ": " + key + " " + what,
                  hint);
  }

  const YAML::Node& map_;
  const std::string& name_;
};

Status read_thresholds(const Reader& reader, MapDescription& map) {
  for (const auto& [key, value] : {std::pair{"occupied_thresh", &map.occupied_thresh},
                                   std::pair{"free_thresh", &map.free_thresh}}) {
    if (!reader.has(key)) continue;
    const Result<double> number = reader.number(key);
    if (!number) return number.error();
    if (*number < 0.0 || *number > 1.0) return reader.wrong(key, "must be from 0 to 1");
    *value = *number;
  }
  if (map.free_thresh > map.occupied_thresh) {
    return reader.wrong("free_thresh", "must not be above occupied_thresh");
  }
  return mauve::ok();
}

Status read_modes(const Reader& reader, MapDescription& map) {
  if (reader.has("negate")) {
    const Result<std::string> text = reader.text("negate");
    if (!text) return text.error();
    map.negate = *text == "1" || *text == "true" || *text == "True";
    if (!map.negate && *text != "0" && *text != "false" && *text != "False") {
      return reader.wrong("negate", "must be 0 or 1");
    }
  }
  if (!reader.has("mode")) return mauve::ok();
  const Result<std::string> mode = reader.text("mode");
  if (!mode) return mode.error();
  if (*mode == "trinary") return mauve::ok();
  return reader.wrong("mode", "is '" + *mode + "'", "only trinary maps are read");
}

Result<MapDescription> read_description(const YAML::Node& root, const std::string& name) {
  if (!root.IsMap()) {
    return refuse(Errc::invalid_value, {}, name + ": is no list of values by name",
                  "a map says 'image: building.pgm', 'resolution: 0.05', 'origin: [0, 0, 0]'");
  }
  const Reader reader(root, name);
  if (Status done = reader.each_key_once(); !done) return done.error();
  MapDescription map;
  const Result<std::string> image = reader.text("image");
  if (!image) return image.error();
  map.image = *image;
  if (map.image.empty()) return reader.wrong("image", "says no file");
  const Result<double> resolution = reader.number("resolution");
  if (!resolution) return resolution.error();
  map.resolution = *resolution;
  if (map.resolution < 1e-4 || map.resolution > 100.0) {
    return reader.wrong("resolution", "must be from 0.0001 to 100", "metres, the edge of a cell");
  }
  const Result<rover::Pose2D> origin = reader.pose("origin");
  if (!origin) return origin.error();
  map.origin = *origin;
  if (std::abs(map.origin.heading) > 2.0 * std::numbers::pi) {
    return reader.wrong("origin", "must have its yaw in radians");
  }
  if (Status done = read_thresholds(reader, map); !done) return done.error();
  if (Status done = read_modes(reader, map); !done) return done.error();
  return map;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

Status written(const std::string& file, const std::string& bytes) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.flush();
  if (stream) return mauve::ok();
  return refuse(Errc::system, {}, "cannot write '" + file + "'", "is there room, and the right?");
}

}  // namespace

Result<MapDescription> parse_description(std::string_view text, const std::string& name) {
  try {
    return read_description(YAML::Load(std::string(text)), name);
  } catch (const YAML::Exception& problem) {
    return refuse(Errc::invalid_value, {},
                  name + ":" + std::to_string(problem.mark.line + 1) + ": " + problem.msg,
                  "a map is described in YAML");
  }
}

void fill_grid(const MapDescription& description, const MapImage& image, OccupancyGrid& into) {
  into.resolution = description.resolution;
  into.origin = description.origin;
  into.width = image.width;
  into.height = image.height;
  into.cells.resize(image.levels.size());
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  for (std::size_t i = 0; i < image.levels.size(); ++i) {
    const double level = image.levels[i] / 255.0;
    const double occupied = description.negate ? level : 1.0 - level;
    const std::size_t row = height - 1 - i / width;
    into.cells[row * width + i % width] = occupied > description.occupied_thresh ? std::int8_t{100}
                                          : occupied < description.free_thresh   ? std::int8_t{0}
                                                                                 : std::int8_t{-1};
  }
}

bool is_unknown_freed(const MapDescription& description, const MapImage& image) {
  const double level = kUnknownLevel / 255.0;
  return (description.negate ? level : 1.0 - level) < description.free_thresh &&
         std::find(image.levels.begin(), image.levels.end(), kUnknownLevel) != image.levels.end();
}

Status load_map(const std::string& file, OccupancyGrid& into) {
  bool frees_unknown = false;
  return load_map(file, into, frees_unknown);
}

Status load_map(const std::string& file, OccupancyGrid& into, bool& frees_unknown) {
  const Result<std::string> text = read_regular_file(file, kLongestDescription, "map");
  if (!text) return text.error();
  const Result<MapDescription> description = parse_description(*text, file);
  if (!description) return description.error();
  const std::string image_file =
      (std::filesystem::path(file).parent_path() / description->image).string();
  const Result<std::string> bytes = read_regular_file(image_file, kLongestImage, "image");
  if (!bytes) return bytes.error();
  const Result<MapImage> image = parse_pgm(*bytes, image_file);
  if (!image) return image.error();
  fill_grid(*description, *image, into);
  frees_unknown = is_unknown_freed(*description, *image);
  return mauve::ok();
}

Status save_map(const OccupancyGrid& grid, const std::string& file) {
  const std::filesystem::path path(file);
  if (path.extension() != ".yaml" || path.stem().empty()) {
    return refuse(Errc::invalid_value, {}, "'" + file + "' does not end in .yaml",
                  "the image gets the same name and .pgm");
  }
  if (!Frame::of(grid)) return refuse(Errc::invalid_value, {}, "there is no map to save");
  const std::string image = path.stem().string() + ".pgm";
  std::string levels =
      "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  const auto width = static_cast<std::size_t>(grid.width);
  for (std::size_t row = static_cast<std::size_t>(grid.height); row-- > 0;) {
    for (std::size_t column = 0; column < width; ++column) {
      const int cell = grid.cells[row * width + column];
      const bool known = cell >= 0 && (cell < 20 || cell > 65);
      levels.push_back(static_cast<char>(!known      ? kUnknownLevel
                                         : cell < 20 ? kFreeLevel
                                                     : kOccupiedLevel));
    }
  }
  if (Status done = written((path.parent_path() / image).string(), levels); !done) return done;
  return written(file, "image: " + image + "\nmode: trinary\nresolution: " +
                           shortest(grid.resolution) + "\norigin: [" + shortest(grid.origin.x) +
                           ", " + shortest(grid.origin.y) + ", " + shortest(grid.origin.heading) +
                           "]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
}

}  // namespace navigation
