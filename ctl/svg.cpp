// SPDX-License-Identifier: LGPL-3.0-or-later
#include "svg.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace mauve::ctl {
namespace {

/// A tenth of a pixel is enough.
std::string pixels(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + pixels(value) + "\"";
}

std::string escaped(std::string_view text) {
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
      default:
        result += c;
    }
  }
  return result;
}

std::string with_space(std::string_view attributes) {
  return attributes.empty() ? std::string{} : " " + std::string(attributes);
}

/// The rest of an element, with what a pointer over it is told.
std::string end_of(std::string_view element, std::string_view title) {
  if (title.empty()) return "/>\n";
  return "><title>" + escaped(title) + "</title></" + std::string(element) + ">\n";
}

}  // namespace

std::string_view line_colour(std::size_t index) {
  constexpr std::array<std::string_view, 6> kColours{"#1f6feb", "#d1242f", "#1a7f37",
                                                     "#9a6700", "#8250df", "#0c7d9d"};
  return kColours[index % kColours.size()];
}

void Svg::rectangle(Place corner, double width, double height, std::string_view attributes,
                    std::string_view title) {
  body_ += "<rect" + attribute("x", corner.x) + attribute("y", corner.y) +
           attribute("width", width) + attribute("height", height) + with_space(attributes) +
           end_of("rect", title);
}

void Svg::circle(Place centre, double radius, std::string_view attributes, std::string_view title) {
  body_ += "<circle" + attribute("cx", centre.x) + attribute("cy", centre.y) +
           attribute("r", radius) + with_space(attributes) + "><title>" + escaped(title) +
           "</title></circle>\n";
}

void Svg::ellipse(Place centre, Place half, double degrees, std::string_view attributes) {
  body_ += "<ellipse" + attribute("rx", half.x) + attribute("ry", half.y) +
           " transform=\"translate(" + pixels(centre.x) + " " + pixels(centre.y) + ") rotate(" +
           pixels(degrees) + ")\"" + with_space(attributes) + "/>\n";
}

void Svg::line(Place from, Place to, std::string_view attributes) {
  body_ += "<line" + attribute("x1", from.x) + attribute("y1", from.y) + attribute("x2", to.x) +
           attribute("y2", to.y) + with_space(attributes) + "/>\n";
}

void Svg::polyline(const std::vector<Place>& places, std::string_view attributes) {
  if (places.size() < 2) return;
  body_ += "<polyline fill=\"none\" points=\"";
  for (const Place& place : places) body_ += pixels(place.x) + "," + pixels(place.y) + " ";
  body_.back() = '"';
  body_ += with_space(attributes) + "/>\n";
}

void Svg::path(std::string_view steps, std::string_view attributes, std::string_view title) {
  body_ +=
      "<path d=\"" + std::string(steps) + "\"" + with_space(attributes) + end_of("path", title);
}

void Svg::define(std::string_view definitions) {
  body_ += "<defs>" + std::string(definitions) + "</defs>\n";
}

void Svg::group(Place at, std::string_view elements) {
  body_ += "<g transform=\"translate(" + pixels(at.x) + " " + pixels(at.y) + ")\">" +
           std::string(elements) + "</g>\n";
}

void Svg::text(Place at, std::string_view words, std::string_view attributes) {
  body_ += "<text" + attribute("x", at.x) + attribute("y", at.y) + with_space(attributes) + ">" +
           escaped(words) + "</text>\n";
}

void Svg::open_clip(Place corner, double width, double height) {
  const std::string name = "clip" + std::to_string(++clips_);
  body_ += "<clipPath id=\"" + name + "\">";
  rectangle(corner, width, height, {});
  body_ += "</clipPath>\n<g clip-path=\"url(#" + name + ")\">\n";
}

void Svg::close_clip() { body_ += "</g>\n"; }

std::string Svg::file() const {
  const std::string size = attribute("width", width_) + attribute("height", height_);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\"" + size +
         " font-family=\"sans-serif\" font-size=\"13\">\n<rect" + size + " fill=\"white\"/>\n" +
         body_ + "</svg>\n";
}

std::string path_step(char letter, Place to) { return letter + pixels(to.x) + " " + pixels(to.y); }

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
