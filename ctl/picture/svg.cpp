// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/concat.h"
#include "render/table.h"

namespace mauve::ctl {
namespace {

/// A tenth of a pixel is enough.
std::string pixels(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

std::string attribute(std::string_view name, double value) {
  return concat({" ", name, "=\"", pixels(value), "\""});
}

/// Of a letter, in parts of the font's size, of a wide font (DejaVu Sans).
double letter_width(char letter) {
  constexpr std::string_view kNarrow = "ijl.,:;'|!()[]/ ftrI-";
  constexpr std::string_view kWide = "mwMW@%";
  if (kNarrow.find(letter) != std::string_view::npos) return 0.41;
  if (kWide.find(letter) != std::string_view::npos) return 1.0;
  return letter >= 'A' && letter <= 'Z' ? 0.75 : 0.64;
}

std::string with_space(std::string_view attributes) {
  return attributes.empty() ? std::string{} : concat({" ", attributes});
}

/// The rest of an element, with the text of its tooltip.
std::string end_of(std::string_view element, std::string_view title) {
  if (title.empty()) return "/>\n";
  return concat({"><title>", escaped_markup(title), "</title></", element, ">\n"});
}

}  // namespace

std::string escaped_markup(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string_view line_colour(std::size_t index) {
  constexpr std::array<std::string_view, 6> kColours{"#1f6feb", "#d1242f", "#1a7f37",
                                                     "#9a6700", "#8250df", "#0c7d9d"};
  return kColours[index % kColours.size()];
}

void Svg::rectangle(Place corner, double width, double height, std::string_view attributes,
                    std::string_view title) {
  body_ += concat({"<rect", attribute("x", corner.x), attribute("y", corner.y),
                   attribute("width", width), attribute("height", height), with_space(attributes),
                   end_of("rect", title)});
}

void Svg::circle(Place centre, double radius, std::string_view attributes, std::string_view title) {
  body_ += concat({"<circle", attribute("cx", centre.x), attribute("cy", centre.y),
                   attribute("r", radius), with_space(attributes), "><title>",
                   escaped_markup(title), "</title></circle>\n"});
}

void Svg::ellipse(Place centre, Place half, double degrees, std::string_view attributes) {
  body_ += concat({"<ellipse", attribute("rx", half.x), attribute("ry", half.y),
                   " transform=\"translate(", pixels(centre.x), " ", pixels(centre.y), ") rotate(",
                   pixels(degrees), ")\"", with_space(attributes), "/>\n"});
}

void Svg::line(Place from, Place to, std::string_view attributes) {
  body_ += concat({"<line", attribute("x1", from.x), attribute("y1", from.y), attribute("x2", to.x),
                   attribute("y2", to.y), with_space(attributes), "/>\n"});
}

void Svg::polyline(const std::vector<Place>& places, std::string_view attributes) {
  if (places.size() < 2) return;
  body_ += "<polyline fill=\"none\" points=\"";
  for (const Place& place : places) body_ += concat({pixels(place.x), ",", pixels(place.y), " "});
  body_.back() = '"';
  body_ += with_space(attributes) + "/>\n";
}

void Svg::path(std::string_view steps, std::string_view attributes, std::string_view title) {
  body_ += concat({"<path d=\"", steps, "\"", with_space(attributes), end_of("path", title)});
}

void Svg::define(std::string_view definitions) {
  body_ += concat({"<defs>", definitions, "</defs>\n"});
}

void Svg::group(Place at, std::string_view elements) {
  body_ += concat(
      {"<g transform=\"translate(", pixels(at.x), " ", pixels(at.y), ")\">", elements, "</g>\n"});
}

void Svg::text(Place at, std::string_view words, std::string_view attributes) {
  body_ += concat({"<text", attribute("x", at.x), attribute("y", at.y), with_space(attributes), ">",
                   escaped_markup(words), "</text>\n"});
}

void Svg::bent(const std::vector<Place>& places, double radius, std::string_view attributes) {
  if (places.size() < 2) return;
  const auto at = [](const Place& place) {
    return concat({pixels(place.x), " ", pixels(place.y)});
  };
  const auto towards = [radius](const Place& from, const Place& to) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const double part = length > 0.0 ? std::min(radius, length / 2.0) / length : 0.0;
    return Place{from.x + (to.x - from.x) * part, from.y + (to.y - from.y) * part};
  };
  body_ += "<path fill=\"none\" d=\"M" + at(places.front());
  for (std::size_t i = 1; i + 1 < places.size(); ++i) {
    body_ += concat({" L", at(towards(places[i], places[i - 1])), " Q", at(places[i]), " ",
                     at(towards(places[i], places[i + 1]))});
  }
  body_ += concat({" L", at(places.back()), "\"", with_space(attributes), "/>\n"});
}

void Svg::polygon(const std::vector<Place>& places, std::string_view attributes) {
  body_ += "<polygon points=\"";
  for (const Place& place : places) body_ += concat({pixels(place.x), ",", pixels(place.y), " "});
  body_.back() = '"';
  body_ += with_space(attributes) + "/>\n";
}

void Svg::open_group(std::string_view attributes, std::string_view title) {
  body_ += concat({"<g", with_space(attributes), ">"});
  if (!title.empty()) body_ += concat({"<title>", escaped_markup(title), "</title>"});
  body_ += "\n";
}

void Svg::close_group() { body_ += "</g>\n"; }

void Svg::open_clip(Place corner, double width, double height) {
  const std::string name = concat({"clip", ++clips_});
  body_ += concat({"<clipPath id=\"", name, "\">"});
  rectangle(corner, width, height, {});
  body_ += concat({"</clipPath>\n<g clip-path=\"url(#", name, ")\">\n"});
}

void Svg::close_clip() { body_ += "</g>\n"; }

std::string Svg::file() const {
  const std::string size = attribute("width", width_) + attribute("height", height_);
  return concat({"<svg xmlns=\"http://www.w3.org/2000/svg\"", size, " viewBox=\"0 0 ",
                 pixels(width_), " ", pixels(height_),
                 "\" font-family=\"sans-serif\" font-size=\"13\">\n<rect", size,
                 " fill=\"white\"/>\n", body_, "</svg>\n"});
}

std::string path_step(char letter, Place to) {
  return letter + concat({pixels(to.x), " ", pixels(to.y)});
}

double text_width(std::string_view words, double size) {
  double width = 0.0;
  for (const char byte : words) width += starts_letter(byte) ? letter_width(byte) * size : 0.0;
  return width;
}

std::string fitted(std::string_view words, double size, double width) {
  if (text_width(words, size) <= width) return std::string(words);
  const double room = width - text_width("…", size);
  std::size_t kept = 0;
  for (double used = 0.0; kept < words.size(); ++kept) {
    if (starts_letter(words[kept])) used += letter_width(words[kept]) * size;
    if (used > room) break;
  }
  return concat({words.substr(0, kept), "…"});
}

double nice_step(double range, int pieces) {
  if (!(range > 0.0) || !std::isfinite(range)) return 1.0;
  const double raw = range / pieces;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace mauve::ctl
