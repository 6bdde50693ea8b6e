// SPDX-License-Identifier: LGPL-3.0-or-later
/// A state machine as a picture: execution states rounded, waits square, from the left to the
/// right.
#include <algorithm>

#include "base/concat.h"
#include "picture/graph_look.h"
#include "picture/layers.h"
#include "picture/machine.h"

namespace mauve::ctl {
namespace {

constexpr double kMachineMargin = 24.0;
constexpr double kMachineHeading = 34.0;
constexpr double kAbove = 26.0;
constexpr double kWidestState = 220.0;
constexpr double kSlot = 16.0;
constexpr double kArrow = 7.0;

/// As high as its transitions need; they leave on the right, one below the other.
struct Circle {
  Box box;
  double above = 0.0;  ///< room for the arrow to the initial state
  double way_in = 0.0;

  Circle(const Machine::State& state, bool is_initial) : above(is_initial ? kAbove : 0.0) {
    const double words = std::max(text_width(state.name, 13.0) * 1.1, text_width(state.wait, 11.0));
    const auto count = static_cast<double>(state.transitions.size());
    box = {std::clamp(words + 36.0, 90.0, kWidestState),
           std::max(46.0, count * kSlot + 16.0) + above};
    way_in = middle();
  }
  [[nodiscard]] double middle() const { return above + (box.height - above) / 2; }
  [[nodiscard]] double way_out(std::size_t transition, std::size_t count) const {
    return middle() +
           (static_cast<double>(transition) - (static_cast<double>(count) - 1.0) / 2.0) * kSlot;
  }
};

class MachineDrawing {
 public:
  explicit MachineDrawing(const Machine& machine) : machine_(machine) {
    for (std::size_t i = 0; i < machine.states.size(); ++i) {
      circles_.emplace_back(machine.states[i], i == machine.initial);
    }
    std::vector<Box> boxes;
    for (const Circle& circle : circles_) {
      boxes.push_back({circle.box.width + kMarkRoom, circle.box.height});
    }
    for (std::size_t i = 0; i < machine.states.size(); ++i) {
      const auto& transitions = machine.states[i].transitions;
      for (std::size_t k = 0; k < transitions.size(); ++k) {
        wires_.push_back({i, circles_[i].way_out(k, transitions.size()), transitions[k].to,
                          circles_[transitions[k].to].way_in});
        marks_.push_back(transitions[k].mark);
      }
    }
    arranged_ = arrange(boxes, wires_, machine.initial);
  }

  [[nodiscard]] std::string file() const {
    const double width = std::max(arranged_.width, 320.0) + 2 * kMachineMargin;
    const double height = kMachineHeading + arranged_.height + 2 * kMachineMargin + 20.0;
    Svg svg(width, height);
    svg.text(
        {kMachineMargin, kMachineMargin + 8},
        fitted(concat({machine_.component, ": ", machine_.type}), 15.4, width - 2 * kMachineMargin),
        "font-size=\"14\" font-weight=\"bold\" fill=\"#1f2328\"");
    for (std::size_t i = 0; i < wires_.size(); ++i) draw_transition(svg, i);
    for (std::size_t i = 0; i < circles_.size(); ++i) draw_state(svg, i);
    svg.text({kMachineMargin, height - kMachineMargin + 4},
             "rounded: runs a method; square: waits; yellow: where it is now",
             "font-size=\"10\" fill=\"#57606a\"");
    return svg.file();
  }

 private:
  /// Beside a state its transitions are marked.
  static constexpr double kMarkRoom = 34.0;

  [[nodiscard]] static Place shifted(const Place& place) {
    return {place.x + kMachineMargin, place.y + kMachineMargin + kMachineHeading};
  }

  static void draw_head(Svg& svg, const Place& at) {
    svg.polygon({{at.x - kArrow, at.y - kArrow / 2}, at, {at.x - kArrow, at.y + kArrow / 2}},
                "fill=\"#1f2328\"");
  }

  [[nodiscard]] double width_of(std::size_t state) const {
    return arranged_.widths[state] - kMarkRoom;
  }

  void draw_transition(Svg& svg, std::size_t index) const {
    const Wire& wire = wires_[index];
    std::vector<Place> route = arranged_.routes[index];
    std::transform(route.begin(), route.end(), route.begin(), shifted);
    const Place from = shifted(arranged_.corners[wire.from]);
    route.insert(route.begin(), {from.x + width_of(wire.from), from.y + wire.from_y});
    svg.open_group("class=\"transition\"",
                   concat({machine_.states[wire.from].name, " to ", machine_.states[wire.to].name,
                           " ", marks_[index]}));
    svg.bent(route, 8.0, "stroke=\"#1f2328\" stroke-width=\"1.2\"");
    draw_head(svg, route.back());
    svg.text({route.front().x + 4, route.front().y - 3}, marks_[index],
             "font-size=\"10\" fill=\"#0b4a8f\"");
    svg.close_group();
  }

  void draw_state(Svg& svg, std::size_t index) const {
    const Machine::State& state = machine_.states[index];
    const Circle& circle = circles_[index];
    Place corner = shifted(arranged_.corners[index]);
    corner.y += circle.above;
    const double width = width_of(index);
    const double height = circle.box.height - circle.above;
    const bool current = machine_.current == index;
    const StateLook look = look_of(state, current);
    svg.open_group(current ? "class=\"state current\"" : "class=\"state\"",
                   state.name + (state.waits ? ", " + state.wait : ""));
    svg.rectangle(corner, width, height,
                  concat({"fill=\"", look.fill, "\" stroke=\"", look.line, "\" stroke-width=\"",
                          current ? "2.4" : "1.5", "\" rx=\"", state.waits ? "2" : "22", "\""}));
    const Place middle{corner.x + width / 2, corner.y + height / 2};
    svg.text({middle.x, middle.y + (state.waits ? -2 : 5)},
             fitted(state.name, 13.0 * 1.1, width - 12.0),
             "text-anchor=\"middle\" font-weight=\"bold\" fill=\"#1f2328\"");
    if (state.waits) {
      svg.text({middle.x, middle.y + 13}, fitted(state.wait, 11.0, width - 12.0),
               "text-anchor=\"middle\" font-size=\"11\" fill=\"#57606a\"");
    }
    svg.close_group();
    if (machine_.initial == index) draw_initial(svg, {middle.x, corner.y});
  }

  /// A dot and an arrow from above, where no transition comes.
  static void draw_initial(Svg& svg, const Place& to) {
    const Place from{to.x, to.y - kAbove + 5};
    svg.open_group("class=\"initial\"", "here it begins");
    svg.circle(from, 5, "fill=\"#1f2328\"", "here it begins");
    svg.line(from, {to.x, to.y - kArrow}, "stroke=\"#1f2328\" stroke-width=\"1.2\"");
    svg.polygon({{to.x - kArrow / 2, to.y - kArrow}, to, {to.x + kArrow / 2, to.y - kArrow}},
                "fill=\"#1f2328\"");
    svg.close_group();
  }

  const Machine& machine_;
  std::vector<Circle> circles_;
  std::vector<Wire> wires_;
  std::vector<std::string> marks_;
  Arrangement arranged_;
};

}  // namespace

std::string machine_svg(const Machine& machine) { return MachineDrawing(machine).file(); }

}  // namespace mauve::ctl
