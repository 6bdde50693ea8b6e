// SPDX-License-Identifier: LGPL-3.0-or-later
#include "../../../plugins/navigation/map_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "../../../plugins/world/random.h"
#include "support/temp_dir.h"

namespace {

using navigation::load_map;
using navigation::OccupancyGrid;
using navigation::parse_description;
using navigation::parse_pgm;
using navigation::save_map;

const std::string kDescription =
    "image: map.pgm\nresolution: 0.05\norigin: [-4.0, -5, 0.1]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

std::string with(const std::string& what, const std::string& by) {
  std::string text = kDescription;
  return text.replace(text.find(what), what.size(), by);
}

void expect_refused(const mauve::Error& error, const std::string& part) {
  EXPECT_NE(error.message.find(part), std::string::npos) << to_string(error);
}

class MapFile : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) {
    return folder_.write(name, bytes).string();
  }
  void expect_not_loaded(const std::string& file, const std::string& part) {
    const mauve::Status done = load_map(file, *grid_);
    ASSERT_FALSE(done) << part;
    expect_refused(done.error(), part);
    EXPECT_EQ(grid_->width, 0) << "nothing changed";
  }

  mauve::test::TempDir folder_;
  std::unique_ptr<OccupancyGrid> grid_ = std::make_unique<OccupancyGrid>();
};

TEST_F(MapFile, IsReadWithTheLowestRowOfTheImageFirst) {
  write("map.pgm", std::string("P5 2 3 255\n") + '\0' + '\xFE' + '\xCD' + '\0' + '\xFE' + '\xFE');
  const std::string file = write("map.yaml", kDescription);

  ASSERT_TRUE(load_map(file, *grid_));

  EXPECT_EQ(grid_->width, 2);
  EXPECT_EQ(grid_->height, 3);
  EXPECT_DOUBLE_EQ(grid_->resolution, 0.05);
  EXPECT_DOUBLE_EQ(grid_->origin.x, -4.0);
  EXPECT_DOUBLE_EQ(grid_->origin.heading, 0.1);
  const std::vector<int> cells(grid_->cells.begin(), grid_->cells.end());
  EXPECT_EQ(cells, (std::vector<int>{0, 0, -1, 100, 100, 0}));
}

TEST_F(MapFile, SaysWhenItsThresholdFreesWhatMapSaverMeansAsUnknown) {
  bool frees = true;
  write("map.pgm", std::string("P5 2 1 255\n\xCD\xFE"));
  ASSERT_TRUE(load_map(write("map.yaml", kDescription), *grid_, frees));
  EXPECT_FALSE(frees);
  EXPECT_EQ(grid_->cells[0], -1);
  const std::string nav2 = write("map.yaml", with("0.196", "0.25"));
  ASSERT_TRUE(load_map(nav2, *grid_, frees));
  EXPECT_TRUE(frees);
  EXPECT_EQ(grid_->cells[0], 0) << "as map_server has it";

  write("map.pgm", std::string("P5 2 1 255\n\xFE\xFE"));
  ASSERT_TRUE(load_map(nav2, *grid_, frees));
  EXPECT_FALSE(frees) << "it has no such cell";
}

TEST_F(MapFile, OfPlainTextAndOfFewerLevelsIsReadAlike) {
  write("map.pgm", "P2\n# made by hand\n2 1 # small\n10\n0\n 10");
  ASSERT_TRUE(load_map(write("map.yaml", kDescription), *grid_));

  EXPECT_EQ(grid_->cells[0], 100);
  EXPECT_EQ(grid_->cells[1], 0);
}

TEST_F(MapFile, IsReadTheOtherWayRoundWhenNegated) {
  write("map.pgm", "P2 2 1 255 0 255");
  ASSERT_TRUE(load_map(write("map.yaml", with("negate: 0", "negate: 1")), *grid_));

  EXPECT_EQ(grid_->cells[0], 0);
  EXPECT_EQ(grid_->cells[1], 100);
}

TEST_F(MapFile, ComesBackAsItWasSaved) {
  world::Random random(1);
  for (int round = 0; round < 30; ++round) {
    OccupancyGrid& grid = *grid_;
    grid.width = 1 + static_cast<int>(random.uniform(0.0, 60.0));
    grid.height = 1 + static_cast<int>(random.uniform(0.0, 60.0));
    grid.resolution = random.uniform(0.01, 1.0);
    grid.origin = {random.uniform(-1e3, 1e3), random.uniform(-1e-3, 1e-3),
                   random.uniform(-3.0, 3.0)};
    grid.cells.resize(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
    for (std::int8_t& cell : grid.cells) {
      const double draw = random.uniform(0.0, 3.0);
      cell = draw < 1.0 ? std::int8_t{0} : draw < 2.0 ? std::int8_t{100} : std::int8_t{-1};
    }
    const std::string file = (folder_.path() / "saved.yaml").string();

    ASSERT_TRUE(save_map(grid, file));
    const auto again = std::make_unique<OccupancyGrid>();
    ASSERT_TRUE(load_map(file, *again));

    EXPECT_EQ(again->width, grid.width);
    EXPECT_EQ(again->height, grid.height);
    EXPECT_EQ(again->resolution, grid.resolution) << "to the last bit";
    EXPECT_EQ(again->origin.x, grid.origin.x);
    EXPECT_EQ(again->origin.y, grid.origin.y);
    EXPECT_EQ(again->origin.heading, grid.origin.heading);
    EXPECT_TRUE(
        std::equal(grid.cells.begin(), grid.cells.end(), again->cells.begin(), again->cells.end()));
  }
}

TEST_F(MapFile, IsNotSavedWhereItCannotBe) {
  EXPECT_FALSE(save_map(*grid_, (folder_.path() / "none.yaml").string())) << "there is no map";
  grid_->width = grid_->height = 1;
  grid_->resolution = 1.0;
  grid_->cells.resize(1);
  EXPECT_FALSE(save_map(*grid_, (folder_.path() / "map.pgm").string())) << "not a name for YAML";
  EXPECT_FALSE(save_map(*grid_, (folder_.path() / "missing" / "map.yaml").string()));
}

TEST_F(MapFile, OfTheProjectHasAYardAndWalls) {
  const auto folder = std::filesystem::path(MAUVE_SOURCE_DIR) / "etc" / "maps";

  ASSERT_TRUE(load_map((folder / "building.yaml").string(), *grid_));

  EXPECT_EQ(grid_->width, 480);
  EXPECT_EQ(grid_->height, 320);
  EXPECT_EQ(grid_->cells[0], 100) << "a corner of the fence";
  EXPECT_EQ(grid_->cells[100 * 480 + 80], 0) << "where the robot starts";
  EXPECT_EQ(grid_->cells[10 * 480 + 460], -1) << "the locked store";
}

TEST_F(MapFile, IsRefusedWithFileAndReason) {
  expect_not_loaded((folder_.path() / "none.yaml").string(), "cannot open the map");
  expect_not_loaded(folder_.path().string(), "cannot open the map");
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_not_loaded(pipe, "it is no regular file");
  const std::string file = write("map.yaml", kDescription);
  expect_not_loaded(file, "cannot open the image");
  write("map.pgm", "P5 4 4 255\nabc");
  expect_not_loaded(file, "no level for cell 3 of 16");
  expect_not_loaded(write("long.yaml", std::string(70'000, '#')), "70000 bytes");
}

TEST(MapDescription, IsRefusedWithLineAndReason) {
  const auto expect = [](const std::string& text, const std::string& part) {
    const auto done = parse_description(text, "m.yaml");
    ASSERT_FALSE(done) << text;
    expect_refused(done.error(), part);
  };
  expect("", "m.yaml: is no list");
  expect("- a\n- b\n", "is no list");
  expect("image: [a\nresolution: 3", "m.yaml:");
  expect(with("image: map.pgm\n", ""), "says no image");
  expect(std::string(kDescription) + "resolution: 0.1\n", "resolution is there twice");
  expect(with("map.pgm", "''"), "m.yaml:1: image says no file");
  expect(with("map.pgm", "[a, b]"), "m.yaml:1: image must be one value");
  for (const char* wrong : {"0", "-0.05", ".nan", "nan", "inf", "1e9", "1e-9", "five", "''"}) {
    expect(with("0.05", wrong), "m.yaml:2: resolution");
  }
  expect(with("resolution: 0.05\n", ""), "says no resolution");
  for (const char* wrong :
       {"3", "[1, 2]", "[1, 2, 3, 4]", "[1, 2, nan]", "[1, [2], 3]", "{a: 1}"}) {
    expect(with("[-4.0, -5, 0.1]", wrong), "m.yaml:3: origin");
  }
  expect(with("0.1]", "90]"), "m.yaml:3: origin must have its yaw in radians");
  expect(with("negate: 0", "negate: maybe"), "m.yaml:4: negate");
  expect(with("0.65", "65"), "m.yaml:5: occupied_thresh");
  expect(with("0.196", "0.7"), "m.yaml:6: free_thresh");
  expect(with("negate: 0", "mode: scale"), "m.yaml:4: mode is 'scale'");
}

TEST(Pgm, IsRefusedWithItsReason) {
  const auto expect = [](const std::string& bytes, const std::string& part) {
    const auto done = parse_pgm(bytes, "m.pgm");
    ASSERT_FALSE(done) << bytes;
    expect_refused(done.error(), part);
  };
  for (const char* wrong : {"", "P5", "P6 1 1 255\nabc", "P52 1 255\n", "\x89PNG\r\n"}) {
    expect(wrong, "is no PGM image");
  }
  for (const char* wrong : {"P5 ", "P5 1", "P5 1 1", "P5 0 4 255\n", "P5 -1 4 255\n",
                            "P5 1x 4 255\n", "P5 99999999999 4 255\n", "P5 # 1 1 255"}) {
    expect(wrong, "no sensible size");
  }
  expect("P5 2049 2048 255\n", "4196352 cells");
  expect("P5 65535 65535 255\n", "4294836225 cells");
  expect("P5 8193 1 255\n", "8193 cells");
  expect("P5 1 1 65535\nab", "largest level is 65535");
  expect("P5 1 1 0\na", "largest level is 0");
  expect("P5 2 2 255\nabc", "cell 3 of 4");
  expect("P5 2 2 255\nabcde", "5 bytes of levels for 4 cells");
  expect("P5\r\n2 2\r\n255\r\nabcd", "5 bytes of levels for 4 cells");
  expect("P2 2 2 255\n1 2 3 4000", "cell 3 of 4");
  expect("P2 2 2 9\n1 2 3 10", "cell 3 of 4");
  expect("P2 2 2 255\n1 2 3 4 5", "has more levels than 4 cells");
}

}  // namespace
