// SPDX-License-Identifier: LGPL-3.0-or-later
// Pictures: pure, values in, SVG out.
#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "picture/map_picture.h"
#include "picture/series_picture.h"
#include "picture/svg.h"

namespace mauve::ctl {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Svg, EscapesTexts) {
  Svg svg(10, 10);
  svg.text({1, 2}, "a<b & c>d");

  EXPECT_THAT(svg.file(), HasSubstr(">a&lt;b &amp; c&gt;d</text>"));
}

TEST(Svg, StepsAreRoundNumbers) {
  EXPECT_DOUBLE_EQ(nice_step(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(nice_step(0.9, 8), 0.2);
  EXPECT_DOUBLE_EQ(nice_step(26.0, 5), 10.0);
  EXPECT_DOUBLE_EQ(nice_step(0.0, 5), 1.0);
  EXPECT_DOUBLE_EQ(nice_step(std::numeric_limits<double>::infinity(), 5), 1.0);
}

TEST(Series, ThatNeverChangesStillHasAxes) {
  const std::string file = draw_series({{"a.b", "m", {{0, 5}, {0, 5}}}});

  EXPECT_THAT(file, HasSubstr("a.b [m]"));
  EXPECT_THAT(file, Not(HasSubstr("nan")));
  EXPECT_THAT(file, Not(HasSubstr("inf")));
}

TEST(Series, OfHugeAndTinyValuesAreDrawnWithinTheirPanel) {
  for (const double size : {1e-12, 1.0, 1e12}) {
    const std::string file = draw_series({{"a.b", "", {{0, -size}, {1, size}}}});
    EXPECT_THAT(file, Not(HasSubstr("nan"))) << size;
    EXPECT_LT(file.size(), 20'000U) << size;
  }
}

MapPicture with_ellipse(double variance_x, double variance_y, double covariance) {
  MapPicture picture;
  picture.way.push_back({{0, 0}, 0, "", variance_x, variance_y, covariance});
  picture.discs.push_back({{0, 0}, 4.3});  // with the air around it a picture of 10 m, 1000 pixels
  return picture;
}

TEST(MapPicture, DrawsTheCovarianceAsTwoDeviations) {
  EXPECT_THAT(
      draw_map(with_ellipse(1.0, 0.25, 0.0)),
      HasSubstr(R"x(rx="200.0" ry="100.0" transform="translate(500.0 500.0) rotate(-0.0)")x"));
  EXPECT_THAT(draw_map(with_ellipse(0.25, 1.0, 0.0)), HasSubstr("rotate(-90.0)"));
  EXPECT_THAT(draw_map(with_ellipse(1.0, 1.0, 0.5)), HasSubstr("rotate(-45.0)"));
  EXPECT_THAT(draw_map(with_ellipse(0.0, 0.0, 0.0)), Not(HasSubstr("<ellipse")));
}

TEST(MapPicture, HasNorthAtTheTop) {
  MapPicture picture;
  picture.discs.push_back({{0, 0}, 4.3});
  picture.goal = Place{0, 2};

  EXPECT_THAT(draw_map(picture), HasSubstr(R"(cx="500.0" cy="300.0" r="9.0")"));
}

TEST(MapPicture, DrawsRunsOfCellsAsLines) {
  MapPicture picture;
  picture.grid = Json::parse(R"({"resolution": 1.0, "width": 3, "height": 2,
    "origin": {"x": 0, "y": 0, "heading": 0}, "cells": [100, 100, 0, -1, 0, 100]})");

  const std::string file = draw_map(picture);

  EXPECT_THAT(file, HasSubstr("#57606a"));
  EXPECT_THAT(file, HasSubstr("#d8dee4"));
}

TEST(MapPicture, OfNothingIsAPicture) {
  EXPECT_THAT(draw_map({}), Not(HasSubstr("nan")));
  MapPicture picture;
  picture.grid = Json::parse(R"({"resolution": 1e-9, "width": 1000000, "cells": [1]})");
  EXPECT_THAT(draw_map(picture), Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace mauve::ctl
