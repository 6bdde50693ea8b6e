// SPDX-License-Identifier: LGPL-3.0-or-later
/// The architecture as a picture: components rounded with their state machine, resources square,
/// inputs on the left and outputs on the right.
#include <algorithm>
#include <array>
#include <optional>

#include "base/concat.h"
#include "picture/graph.h"
#include "picture/graph_look.h"
#include "picture/layers.h"

namespace mauve::ctl {
namespace {

constexpr double kMargin = 24.0;
constexpr double kHeading = 34.0;
constexpr double kGraphLegend = 46.0;
constexpr double kPadding = 12.0;
constexpr double kNameSize = 13.0;
constexpr double kSmallSize = 10.0;
constexpr double kDoorSize = 11.0;
constexpr double kDoorHeight = 16.0;
constexpr double kWidest = 230.0;
constexpr double kMarker = 5.0;

std::string style_of(Flow flow) {
  const FlowLook& look = look_of(flow);
  const std::string stroke = concat({"stroke=\"", look.line, "\" stroke-width=\""});
  if (look.stroke == Stroke::solid) return stroke + "1.2\"";
  return concat(
      {stroke, "1.8\" stroke-dasharray=\"", look.stroke == Stroke::dashed ? "7 4" : "2 3", "\""});
}

std::string colour(std::string_view fill, std::string_view line) {
  return concat({"fill=\"", fill, "\" stroke=\"", line, "\""});
}

/// A port or service at a side of its box.
struct Spot {
  const Graph::Door* door = nullptr;
  bool is_port = false;
  bool left = false;
  double below = 0.0;  ///< of the upper edge
};

/// The texts of a box, and its size.
struct Card {
  struct Line {
    std::string text;
    double size;
    bool framed = false;  ///< the state machine
  };
  std::vector<Line> lines;
  std::vector<Spot> spots;
  Box box;

  explicit Card(const Graph::Node& node) {
    add(node.name, kNameSize);
    add(node.type, kSmallSize);
    if (!node.is_resource && node.core != node.type) add("core " + node.core, kSmallSize);
    if (!node.is_resource && !node.fsm_state.empty()) {
      lines.push_back({concat({node.fsm.substr(node.fsm.rfind('/') + 1), ": ", node.fsm_state}),
                       kSmallSize, true});
      widen(lines.back());
    }
    if (!node.state.empty() && node.state != "running") add(node.state, kSmallSize);
    box.height = kPadding;
    for (const Line& line : lines) box.height += height_of(line);
    add_spots(node);
    box.width = std::min(box.width + 2 * kPadding, kWidest);
  }

  [[nodiscard]] static double height_of(const Line& line) {
    return line.framed ? 23.0 : line.size + 5.0;
  }
  [[nodiscard]] const Spot* find(const Graph::Door& door) const {
    const auto found = std::find_if(spots.begin(), spots.end(),
                                    [&](const Spot& spot) { return spot.door == &door; });
    return found == spots.end() ? nullptr : &*found;
  }

 private:
  void add(const std::string& text, double size) {
    if (text.empty()) return;
    lines.push_back({text, size});
    widen(lines.back());
  }
  void widen(const Line& line) {
    box.width = std::max(box.width, text_width(line.text, line.size) * (line.size > 12 ? 1.1 : 1) +
                                        (line.framed ? 16.0 : 0.0));
  }
  /// Both sides have rows of their own.
  void add_spots(const Graph::Node& node) {
    double left = box.height + 4.0;
    double right = left;
    std::array<double, 2> widest{};
    const auto place = [&](const Graph::Door& door, bool is_port) {
      const bool on_left = door.reads() == is_port;
      double& y = on_left ? left : right;
      spots.push_back({&door, is_port, on_left, y + kDoorHeight / 2});
      y += kDoorHeight;
      auto& width = widest[on_left ? 0 : 1];
      width = std::max(width, text_width(door.name, kDoorSize));
    };
    for (const Graph::Door& door : node.services) place(door, false);
    for (const Graph::Door& door : node.ports) place(door, true);
    box.width = std::max(box.width, widest[0] + widest[1] + 14.0);
    box.height = spots.empty() ? box.height + 4.0 : std::max(left, right) + 5.0;
  }
};

/// Dark for ports, light for services; triangles for values, diamonds for calls, dots for events.
void draw_marker(Svg& svg, const Place& at, const Spot& spot, std::string_view line, bool open) {
  const std::string_view fill = open ? "white" : spot.is_port ? line : std::string_view("white");
  const std::string look = colour(fill, open ? kWrong : line) + " stroke-width=\"1.2\"";
  const std::string& kind = spot.door->kind;
  if (kind == "event") return svg.circle(at, kMarker - 1, look, kind);
  if (kind == "call") {
    return svg.polygon({{at.x - kMarker, at.y},
                        {at.x, at.y - kMarker},
                        {at.x + kMarker, at.y},
                        {at.x, at.y + kMarker}},
                       look);
  }
  svg.polygon(
      {{at.x - kMarker, at.y - kMarker}, {at.x + kMarker, at.y}, {at.x - kMarker, at.y + kMarker}},
      look);
}

/// A port that leads nowhere ends in a cross.
void draw_open_end(Svg& svg, const Place& at, bool left) {
  const double x = at.x + (left ? -15.0 : 15.0);
  const std::string look = concat({"stroke=\"", kWrong, "\" stroke-width=\"1.4\""});
  svg.line(at, {x, at.y}, look);
  svg.line({x - 3, at.y - 3}, {x + 3, at.y + 3}, look);
  svg.line({x - 3, at.y + 3}, {x + 3, at.y - 3}, look);
}

class GraphDrawing {
 public:
  explicit GraphDrawing(const Graph& graph)
      : graph_(graph), cards_(graph.nodes.begin(), graph.nodes.end()) {
    std::vector<Box> boxes;
    for (const Card& card : cards_) boxes.push_back(card.box);
    std::vector<Wire> wires;
    for (const Graph::Link& link : graph.links) wires.push_back(wire_of(link));
    arranged_ = arrange(boxes, wires);
  }

  [[nodiscard]] std::string file() const {
    const double width = std::max(arranged_.width, kLegendWidth) + 2 * kMargin;
    const double height = kHeading + arranged_.height + kGraphLegend + 2 * kMargin;
    Svg svg(width, height);
    svg.text({kMargin, kMargin + 8},
             fitted(concat({graph_.name, ", generation ", graph_.generation}), 14.0,
                    width - 2 * kMargin),
             "font-size=\"14\" font-weight=\"bold\" fill=\"#1f2328\"");
    for (const Flow flow : {Flow::alive, Flow::resting, Flow::stale, Flow::dead})
      draw_links(svg, flow);
    for (const Place& joint : arranged_.joints)
      svg.circle(shifted(joint), 2.2, "fill=\"#1f2328\"", "parts here");
    for (std::size_t i = 0; i < cards_.size(); ++i) draw_node(svg, i);
    draw_legend(svg, height - kMargin - 14.0);
    return svg.file();
  }

 private:
  static constexpr double kLegendWidth = 760.0;

  [[nodiscard]] Wire wire_of(const Graph::Link& link) const {
    const Graph::Door& port = graph_.port(link);
    const Graph::Door& service = graph_.nodes[link.resource].services[link.service];
    const Spot* user = cards_[link.user].find(port);
    const Spot* used = cards_[link.resource].find(service);
    if (port.reads()) return {link.resource, used->below, link.user, user->below};
    return {link.user, user->below, link.resource, used->below};
  }

  [[nodiscard]] static Place shifted(const Place& place) {
    return {place.x + kMargin, place.y + kMargin + kHeading};
  }

  void draw_links(Svg& svg, Flow flow) const {
    for (std::size_t i = 0; i < graph_.links.size(); ++i) {
      const Graph::Link& link = graph_.links[i];
      if (link.flow != flow) continue;
      const Graph::Node& user = graph_.nodes[link.user];
      const Graph::Node& resource = graph_.nodes[link.resource];
      const std::array<const char*, 4> says{"", " (stopped)", " (stale)", " (dead)"};
      svg.open_group(
          "class=\"link\"",
          concat({user.name, ".ports.", graph_.port(link).name, " - ", resource.name, ".",
                  resource.services[link.service].name, says[static_cast<std::size_t>(flow)]}));
      std::vector<Place> route = arranged_.routes[i];
      std::transform(route.begin(), route.end(), route.begin(), shifted);
      svg.bent(route, 6.0, style_of(flow));
      svg.close_group();
    }
  }

  void draw_node(Svg& svg, std::size_t index) const {
    const Graph::Node& node = graph_.nodes[index];
    const Card& card = cards_[index];
    const NodeLook& look = look_of(node);
    const Place corner = shifted(arranged_.corners[index]);
    const double width = arranged_.widths[index];
    svg.open_group(node.is_resource ? "class=\"resource\"" : "class=\"component\"",
                   node.name + (node.state.empty() ? "" : ": " + node.state));
    svg.rectangle(corner, width, card.box.height,
                  concat({colour(look.fill, look.line), " stroke-width=\"1.5\"",
                          node.is_resource ? "" : " rx=\"12\""}));
    draw_lines(svg, card, look, corner, width);
    for (const Spot& spot : card.spots) draw_spot(svg, index, spot, corner, width);
    svg.close_group();
  }

  static void draw_lines(Svg& svg, const Card& card, const NodeLook& look, const Place& corner,
                         double width) {
    const double middle = corner.x + width / 2;
    double y = corner.y + kPadding / 2;
    for (const Card::Line& line : card.lines) {
      const double room = width - (line.framed ? 28.0 : 12.0);
      const bool title = &line == &card.lines.front();
      const std::string words = fitted(line.text, line.size * (title ? 1.1 : 1.0), room);
      if (line.framed) {
        const double half = text_width(words, line.size) / 2 + 9;
        svg.rectangle({middle - half, y + 4}, 2 * half, 17,
                      colour("white", look.line) + " stroke-width=\"0.8\" rx=\"8\"");
        svg.circle({middle - half + 8, y + 12.5}, 3, colour(look.line, "none"), "state machine");
        y += 2;
      }
      svg.text(
          {line.framed ? middle + 5 : middle, y + line.size + (line.framed ? 4 : 3)}, words,
          concat({"text-anchor=\"middle\" font-size=\"", static_cast<int>(line.size), "\" fill=\"",
                  title ? look.text : "#57606a", "\"", title ? " font-weight=\"bold\"" : ""}));
      y += Card::height_of(line) - (line.framed ? 2 : 0);
    }
  }

  void draw_spot(Svg& svg, std::size_t index, const Spot& spot, const Place& corner,
                 double width) const {
    const Graph::Node& node = graph_.nodes[index];
    const Place at{corner.x + (spot.left ? 0.0 : width), corner.y + spot.below};
    const bool open =
        spot.is_port &&
        !graph_.is_connected(index, static_cast<std::size_t>(spot.door - node.ports.data()));
    if (open) draw_open_end(svg, at, spot.left);
    draw_marker(svg, at, spot, look_of(node).line, open);
    svg.text({at.x + (spot.left ? 9.0 : -9.0), at.y + 4},
             fitted(spot.door->name, kDoorSize, width / 2 + 20),
             concat({"font-size=\"11\" fill=\"", look_of(node).text, "\"",
                     spot.left ? "" : " text-anchor=\"end\""}));
  }

  /// Explains only the signs that occur in this picture.
  void draw_legend(Svg& svg, double y) const {
    double x = kMargin;
    const auto say = [&](std::string_view words) {
      svg.text({x, y + 4}, words, "font-size=\"10\" fill=\"#57606a\"");
      x += text_width(words, 10.0) + 18.0;
    };
    const auto flows = [&](Flow flow) {
      return std::any_of(graph_.links.begin(), graph_.links.end(),
                         [flow](const Graph::Link& link) { return link.flow == flow; });
    };
    const auto line = [&](Flow flow, std::string_view words) {
      if (!flows(flow)) return;
      svg.line({x, y}, {x + 26, y}, style_of(flow));
      x += 32.0;
      say(words);
    };
    for (const std::string_view kind : {"read", "call", "event"}) {
      const Graph::Door door{"", std::string(kind), ""};
      if (!has_kind(kind)) continue;
      draw_marker(svg, {x + 5, y}, {&door, true}, "#1f2328", false);
      draw_marker(svg, {x + 19, y}, {&door, false}, "#1f2328", false);
      x += 30.0;
      say(kind == "read" ? "port, service" : kind);
    }
    line(Flow::alive, "data");
    line(Flow::resting, "of a stopped component");
    line(Flow::stale, look_of(Flow::stale).word);
    line(Flow::dead, look_of(Flow::dead).word);
  }

  [[nodiscard]] bool has_kind(std::string_view kind) const {
    return std::any_of(graph_.nodes.begin(), graph_.nodes.end(), [&](const Graph::Node& node) {
      const auto is = [&](const Graph::Door& door) {
        return door.kind == kind || (kind == "read" && door.kind == "write");
      };
      return std::any_of(node.ports.begin(), node.ports.end(), is) ||
             std::any_of(node.services.begin(), node.services.end(), is);
    });
  }

  const Graph& graph_;
  std::vector<Card> cards_;
  Arrangement arranged_;
};

}  // namespace

std::string graph_svg(const Graph& graph) { return GraphDrawing(graph).file(); }

}  // namespace mauve::ctl
