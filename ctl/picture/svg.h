// SPDX-License-Identifier: LGPL-3.0-or-later
/// Scalable vector graphics: as much of it as plots and maps need.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mauve::ctl {

/// A place in the picture, or in the world that it shows.
struct Place {
  double x = 0.0;
  double y = 0.0;
};

/// A text between the tags of markup, or in its quotes: no letter of it means anything there.
[[nodiscard]] std::string escaped_markup(std::string_view text);

/// The colours of lines that must be distinguished, over and over.
[[nodiscard]] std::string_view line_colour(std::size_t index);

/// A picture in pixels, y downwards. Texts are escaped, attributes are written as they are.
class Svg {
 public:
  Svg(double width, double height) : width_(width), height_(height) {}

  void rectangle(Place corner, double width, double height, std::string_view attributes,
                 std::string_view title = {});
  void circle(Place centre, double radius, std::string_view attributes,
              std::string_view title = {});
  /// Half axes in pixels, turned by `degrees`.
  void ellipse(Place centre, Place half, double degrees, std::string_view attributes);
  void line(Place from, Place to, std::string_view attributes);
  /// Nothing for fewer than two places.
  void polyline(const std::vector<Place>& places, std::string_view attributes);
  /// `steps` as SVG has them: "M0 0L10 0".
  void path(std::string_view steps, std::string_view attributes, std::string_view title = {});
  /// Patterns and styles for the drawing that follows, as SVG.
  void define(std::string_view definitions);
  /// Elements as SVG, moved to a place.
  void group(Place at, std::string_view elements);
  /// Where it ends is known when it is drawn.
  void set_height(double height) { height_ = height; }
  void text(Place at, std::string_view words, std::string_view attributes = {});
  /// A polyline with rounded corners; nothing for fewer than two places.
  void bent(const std::vector<Place>& places, double radius, std::string_view attributes);
  void polygon(const std::vector<Place>& places, std::string_view attributes);
  /// The shapes drawn until close_group() belong together; the title is shown where the mouse is.
  void open_group(std::string_view attributes, std::string_view title = {});
  void close_group();
  /// The shapes drawn until the next open() or close() are cut off outside of the rectangle.
  void open_clip(Place corner, double width, double height);
  void close_clip();

  /// The whole file.
  [[nodiscard]] std::string file() const;

 private:
  double width_;
  double height_;
  std::string body_;
  int clips_ = 0;
};

/// "M10.5 3.0": to a tenth of a pixel.
[[nodiscard]] std::string path_step(char letter, Place to);
/// How wide the text is at most, in pixels: there are no fonts to ask.
[[nodiscard]] double text_width(std::string_view words, double size);
/// As much of it as fits, with "…" at the end of a text that was cut.
[[nodiscard]] std::string fitted(std::string_view words, double size, double width);

/// Steps of 1, 2 or 5 times a power of ten that part the range in about so many pieces.
[[nodiscard]] double nice_step(double range, int pieces);

}  // namespace mauve::ctl
