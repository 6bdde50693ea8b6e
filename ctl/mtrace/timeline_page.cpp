// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/timeline_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

constexpr double kMargin = 24.0;  // pixels on both sides of legend and notes
constexpr std::size_t kColours = 8;
constexpr std::size_t kMostStates = 12;  // in the legend
constexpr std::size_t kMostNotes = 6;

/// Reds and oranges are for faults and late jobs.
constexpr std::string_view kStyle =
    "<style>"
    ".s0{fill:#a5d6ff}.s1{fill:#aceebb}.s2{fill:#fae17d}.s3{fill:#d8b9ff}.s4{fill:#9eecec}"
    ".s5{fill:#ffc9e6}.s6{fill:#e8d5b5}.s7{fill:#d0d7de}"
    ".state,.job,.many{stroke:#1f2328;stroke-width:.7}.job{fill:#eaeef2}.many{fill:#8c959f}"
    ".preempted{fill:url(#hatched);stroke:#57606a;stroke-width:.6;stroke-dasharray:3 2}"
    ".blocked{fill:url(#waiting);stroke:#bc4c00;stroke-width:.6}"
    ".held{fill:#9a6700}.overrun{fill:#cf222e;fill-opacity:.35;stroke:#cf222e}"
    ".release{stroke:#1f2328;stroke-width:1.1;fill:none}"
    ".deadline{stroke:#cf222e;stroke-width:1.1;fill:none}"
    ".missed{stroke:#cf222e;stroke-width:1.1;stroke-dasharray:3 2;fill:none}"
    ".fault{stroke:#cf222e;stroke-width:2.4;fill:none}"
    ".user{fill:#0969da}.applied{fill:#8250df;stroke:white;stroke-width:.8}"
    ".prepare{fill:url(#preparing);stroke:#8250df;stroke-width:.7}"
    ".commit{stroke:#8250df;stroke-width:1.3;stroke-dasharray:6 3}"
    ".rollback{stroke:#cf222e;stroke-width:1.3;stroke-dasharray:6 3}"
    ".aborted{stroke:#8c959f;stroke-width:1;stroke-dasharray:2 3}"
    ".disturbed{fill:#6e7781;fill-opacity:.18}"
    ".grid{stroke:#eaeef2}.zero{stroke:#57606a;stroke-width:1.2}"
    ".baseline{stroke:#57606a}.stopped{stroke:white;stroke-width:2;stroke-dasharray:5 5}"
    ".small{font-size:10.5px;fill:#57606a}"
    "text.label{font-size:11px;stroke:white;stroke-width:3;stroke-dasharray:none;"
    "paint-order:stroke;stroke-linejoin:round}"
    "text.commit{fill:#8250df}text.rollback,text.wrong{fill:#cf222e}text.aborted{fill:#6e7781}"
    "text{pointer-events:none}"
    "</style>";

std::string hatch(std::string_view id, std::string_view back, std::string_view line) {
  return "<pattern id=\"" + std::string(id) +
         "\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" "
         "patternTransform=\"rotate(45)\"><rect width=\"6\" height=\"6\" fill=\"" +
         std::string(back) + "\"/><path d=\"M0 0V6\" stroke=\"" + std::string(line) +
         "\" stroke-width=\"2.4\"/></pattern>";
}

struct Unit {
  double ns;
  std::string_view name;
};

Unit unit_for(double range) {
  if (range >= 2e9) return {1e9, "s"};
  if (range >= 2e6) return {1e6, "ms"};
  return range >= 2e3 ? Unit{1e3, "us"} : Unit{1.0, "ns"};
}

/// Far behind T0, ticks count from a round instant: else their labels were too long to be read.
std::int64_t base_for(std::int64_t from, std::int64_t to) {
  const std::int64_t range = to - from;
  if (std::abs(from) / 20 < range) return 0;
  std::int64_t round = 1;
  while (round < 2 * range) round *= 10;
  return from / round * round;
}

std::string tick_text(double value, double step) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string seconds_exactly(std::int64_t ns) {
  std::string text = instant_in_words(ns);
  text.resize(text.size() - 2);  // " s"
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return ns == 0 ? std::string("T0") : text + " s";
}

struct SignWords {
  Sign sign;
  std::string_view drawing;  ///< the sign in a legend, in a box of 22 x 12 pixels
  std::string_view words;
};

constexpr SignWords kSignWords[] = {
    {Sign::release, R"(<path class="release" d="M11 12V0M8 4L11 0L14 4"/>)", "release"},
    {Sign::job, R"(<rect class="job" width="22" height="12"/>)", "job"},
    {Sign::many, R"(<rect class="many" width="22" height="12"/>)", "several jobs"},
    {Sign::preempted, R"(<rect class="preempted" width="22" height="12"/>)", "preempted"},
    {Sign::blocked, R"(<rect class="blocked" width="22" height="12"/>)", "waits for a lock"},
    {Sign::held, R"(<rect class="held" y="4" width="22" height="4"/>)", "holds a lock"},
    {Sign::deadline, R"(<path class="deadline" d="M11 0V12M8 8L11 12L14 8"/>)", "deadline"},
    {Sign::overrun, R"(<rect class="overrun" width="22" height="12"/>)", "after its deadline"},
    {Sign::missed, R"(<path class="missed" d="M11 12V0M8 4L11 0L14 4"/>)", "missed release"},
    {Sign::fault, R"(<path class="fault" d="M6 1L16 11M16 1L6 11"/>)", "fault"},
    {Sign::user, R"(<circle class="user" cx="11" cy="6" r="3.5"/>)", "event of the core"},
    {Sign::stopped, R"(<path class="baseline" d="M0 6H22"/><path class="stopped" d="M0 6H22"/>)",
     "stopped"},
    {Sign::applied, R"(<path class="applied" d="M11 0L16 6L11 12L6 6Z"/>)", "applies a change"},
    {Sign::prepare, R"(<rect class="prepare" width="22" height="12"/>)", "change is prepared"},
    {Sign::commit, R"(<path class="commit" d="M11 0V12"/>)", "instant of a change"},
    {Sign::rollback, R"(<path class="rollback" d="M11 0V12"/>)", "rollback"},
    {Sign::aborted, R"(<path class="aborted" d="M11 0V12"/>)", "change aborted"},
    {Sign::disturbed, R"(<rect class="disturbed" width="22" height="12"/>)",
     "disturbed from outside"},
};

}  // namespace

Page::Page(const Trace& trace, const Scene& scene, double top_of_rows, double bottom_of_rows)
    : top(top_of_rows),
      bottom(bottom_of_rows),
      svg(kWidth, bottom_of_rows),
      trace_(trace),
      from_(scene.from),
      to_(scene.to) {
  svg.define(std::string(kStyle) + hatch("hatched", "#ffffff", "#afb8c1") +
             hatch("waiting", "#fff1e5", "#ffb77c") + hatch("preparing", "#fbefff", "#d8b9ff"));
}

double Page::x(std::int64_t time) const {
  const double share = static_cast<double>(time - from_) / static_cast<double>(to_ - from_);
  // Far outside of the picture is far enough: SVG's numbers end somewhere.
  return left + std::clamp(share, -1.0, 2.0) * kInner;
}

std::string Page::colour_of(Word state) {
  const auto [known, fresh] = colours_.try_emplace(state, colours_.size());
  if (fresh) states_.push_back(state);
  return "s" + std::to_string(known->second % kColours);
}

void Page::draw_axis() {
  const auto range = static_cast<double>(to_ - from_);
  const Unit unit = unit_for(range);
  const std::int64_t base = base_for(from_, to_);
  const double step = nice_step(range / unit.ns, 12);
  const double low = static_cast<double>(from_ - base) / unit.ns;
  const double high = static_cast<double>(to_ - base) / unit.ns;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1.0) {
    const double at = left + (i * step - low) / (high - low) * kInner;
    const bool zero = base == 0 && i == 0.0;
    svg.path(path_step('M', {at, top}) + path_step('L', {at, bottom + 5}),
             zero ? "class=\"zero\"" : "class=\"grid\"");
    svg.text({at, bottom + 19}, zero ? "T0" : tick_text(i * step, step),
             "text-anchor=\"middle\" font-size=\"12\" class=\"tick\"");
  }
  svg.path(path_step('M', {left, bottom}) + path_step('L', {right, bottom}), "class=\"baseline\"");
  svg.text({(left + right) / 2, bottom + 37},
           "time since " + seconds_exactly(base) + " [" + std::string(unit.name) + "]",
           "text-anchor=\"middle\" font-size=\"12\" class=\"axis\"");
}

void Page::draw_baseline(double y, std::string_view name, std::string_view more) {
  svg.path(path_step('M', {left, y}) + path_step('L', {right, y}), "class=\"baseline\"");
  svg.text({left - 10, y - 11}, cut(name, 22), "text-anchor=\"end\" class=\"name\"");
  svg.text({left - 10, y + 1}, cut(more, 28), "text-anchor=\"end\" class=\"small\"");
}

/// States, then signs, from left to right in as many lines as they need. Returns where it ends.
double Page::draw_legend(double y) {
  double at = kMargin;
  const auto next = [&](std::string_view words) {
    const double width = 30.0 + text_width(words, 12.0) + 18.0;
    if (at + width > kWidth - kMargin) {
      at = kMargin;
      y += 20.0;
    }
    const Place place{at, y};
    at += width;
    svg.text({place.x + 28, place.y + 10.5}, words, "font-size=\"12\"");
    return place;
  };
  for (std::size_t i = 0; i < std::min(states_.size(), kMostStates); ++i) {
    const Place place = next(cut(trace_.text(states_[i]), 24));
    svg.rectangle(place, 22, 12, "class=\"state " + colour_of(states_[i]) + "\"");
  }
  if (states_.size() > kMostStates) {
    next("and " + counted(states_.size() - kMostStates, "state") + " more");
  }
  for (const SignWords& one : kSignWords) {
    if (!occurring_[static_cast<std::size_t>(one.sign)]) continue;
    svg.group(next(one.words), one.drawing);
  }
  return y + 20.0;
}

std::string Page::file(const std::string& title, const std::vector<std::string>& left_out) {
  svg.text({kMargin, 24}, title, "font-size=\"16\" font-weight=\"bold\" class=\"title\"");
  double y = draw_legend(bottom + 50) + 12.0;
  for (std::size_t i = 0; i < left_out.size(); ++i, y += 14.0) {
    const bool rest = i + 1 == kMostNotes && left_out.size() > kMostNotes;
    svg.text({kMargin, y},
             rest ? "and " + std::to_string(left_out.size() - i) + " more"
                  : "not shown: " + cut(left_out[i], 180),
             "class=\"small note\"");
    if (rest) break;
  }
  svg.set_height(y + 8.0);
  return svg.file();
}

}  // namespace mauve::ctl::mtrace
