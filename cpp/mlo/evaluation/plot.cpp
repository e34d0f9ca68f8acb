#include "mlo/evaluation/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

#include <fmt/format.h>

namespace mlo {
namespace {

// Okabe and Ito's palette, told apart by the colour-blind too.
constexpr std::array<std::string_view, 8> kColors{"#444444", "#0072b2", "#d55e00", "#009e73",
                                                  "#cc79a7", "#e69f00", "#56b4e9", "#a6761d"};
constexpr double kWidth_px = 900.0;
constexpr double kLeft_px = 80.0;
constexpr double kRight_px = 24.0;
constexpr double kTop_px = 56.0;
constexpr double kBottom_px = 52.0;
constexpr double kPlotWidth_px = kWidth_px - kLeft_px - kRight_px;
constexpr double kPlotHeight_px = 240.0;
constexpr double kMinMapHeight_px = 160.0;
constexpr double kMaxMapHeight_px = 640.0;
constexpr int kTicks = 8;

struct Range {
  double min = std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::lowest();

  double size() const { return max - min; }
  void include(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  void widen_to(double size_wanted) {
    const double missing = std::max(0.0, size_wanted - size());
    min -= 0.5 * missing;
    max += 0.5 * missing;
  }
};

struct Frame {
  Range x;
  Range y;
  double top_px = 0.0;
  double height_px = kPlotHeight_px;

  double x_px(double value) const { return kLeft_px + kPlotWidth_px * (value - x.min) / x.size(); }
  double y_px(double value) const { return top_px + height_px * (y.max - value) / y.size(); }
  double bottom_px() const { return top_px + height_px; }
};

// A step of 1, 2 or 5 times a power of ten that gives at most kTicks ticks.
double tick_step(double size) {
  const double raw = size / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> ticks(const Range& range) {
  const double step = tick_step(range.size());
  std::vector<double> values;
  const auto last = static_cast<long>(std::floor(range.max / step + 1e-9));
  for (auto i = static_cast<long>(std::ceil(range.min / step - 1e-9)); i <= last; ++i) {
    values.push_back(static_cast<double>(i) * step);
  }
  return values;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '&') {
      result += "&amp;";
    } else {
      result += c;
    }
  }
  return result;
}

Frame frame_of(const PlotPanel& panel, double top_px) {
  Frame frame;
  for (const PlotCurve& curve : panel.curves) {
    for (const Eigen::Vector2d& point : curve.points) {
      if (!point.allFinite()) continue;
      frame.x.include(point.x());
      frame.y.include(point.y());
    }
  }
  if (frame.x.min > frame.x.max) frame.x = frame.y = {.min = 0.0, .max = 1.0};  // nothing to draw
  if (!panel.equal_scale) frame.y.include(0.0);
  for (Range* range : {&frame.x, &frame.y}) {
    range->widen_to(std::max(1e-9, 1e-6 * std::abs(range->max)));
    if (panel.equal_scale || range == &frame.y) range->widen_to(1.06 * range->size());
  }
  if (panel.equal_scale) {
    frame.y.widen_to(frame.x.size() * kMinMapHeight_px / kPlotWidth_px);
    frame.x.widen_to(frame.y.size() * kPlotWidth_px / kMaxMapHeight_px);
    frame.height_px = kPlotWidth_px * frame.y.size() / frame.x.size();
  }
  frame.top_px = top_px + kTop_px;
  return frame;
}

void draw_text(std::string& svg, double x, double y, std::string_view attributes, std::string_view text) {
  fmt::format_to(std::back_inserter(svg), "<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, attributes,
                 escaped(text));
}

void draw_axes(std::string& svg, const PlotPanel& panel, const Frame& frame) {
  const auto line = [&](double x1, double y1, double x2, double y2) {
    fmt::format_to(std::back_inserter(svg),
                   "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/>\n", x1, y1,
                   x2, y2);
  };
  // Twelve digits drop what rounding adds to 0.1 * 3.
  for (const double value : ticks(frame.x)) {
    line(frame.x_px(value), frame.top_px, frame.x_px(value), frame.bottom_px());
    draw_text(svg, frame.x_px(value), frame.bottom_px() + 18.0, "class=\"middle\"",
              fmt::format("{:.12g}", value));
  }
  for (const double value : ticks(frame.y)) {
    line(kLeft_px, frame.y_px(value), kLeft_px + kPlotWidth_px, frame.y_px(value));
    draw_text(svg, kLeft_px - 8.0, frame.y_px(value) + 4.0, "class=\"end\"", fmt::format("{:.12g}", value));
  }
  fmt::format_to(std::back_inserter(svg),
                 "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"frame\"/>\n",
                 kLeft_px, frame.top_px, kPlotWidth_px, frame.height_px);
  const double middle_x = kLeft_px + 0.5 * kPlotWidth_px;
  const double middle_y = frame.top_px + 0.5 * frame.height_px;
  draw_text(svg, kLeft_px, frame.top_px - 30.0, "class=\"title\"", panel.title);
  draw_text(svg, middle_x, frame.bottom_px() + 38.0, "class=\"middle\"", panel.x_label);
  draw_text(svg, 20.0, middle_y,
            fmt::format("class=\"middle\" transform=\"rotate(-90 20 {:.1f})\"", middle_y), panel.y_label);
}

void draw_curve(std::string& svg, const PlotCurve& curve, const Frame& frame) {
  std::string path;
  bool pen_down = false;
  for (const Eigen::Vector2d& point : curve.points) {
    if (point.allFinite()) {
      fmt::format_to(std::back_inserter(path), "{}{:.2f} {:.2f}", pen_down ? 'L' : 'M', frame.x_px(point.x()),
                     frame.y_px(point.y()));
    }
    pen_down = point.allFinite();
  }
  fmt::format_to(std::back_inserter(svg), "<path d=\"{}\" class=\"curve\" stroke=\"{}\"/>\n", path,
                 kColors[curve.color % kColors.size()]);
}

void draw_legend(std::string& svg, const PlotPanel& panel, const Frame& frame) {
  double x = kLeft_px;
  const double y = frame.top_px - 12.0;
  for (const PlotCurve& curve : panel.curves) {
    fmt::format_to(std::back_inserter(svg),
                   "<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\" class=\"curve\" "
                   "stroke=\"{3}\"/>\n",
                   x, y - 4.0, x + 22.0, kColors[curve.color % kColors.size()]);
    draw_text(svg, x + 28.0, y, "", curve.name);
    x += 52.0 + 7.0 * static_cast<double>(curve.name.size());
  }
}

constexpr std::string_view kStyle =
    "<style>text{font:13px "
    "sans-serif;fill:#222}.title{font-size:15px;font-weight:bold}.middle{text-anchor:middle}"
    ".end{text-anchor:end}.grid{stroke:#ddd}.frame{fill:none;stroke:#888}"
    ".curve{fill:none;stroke-width:1.6;stroke-linejoin:round}</style>\n";

}  // namespace

std::string svg_plot(std::span<const PlotPanel> panels) {
  std::string body;
  double height_px = 0.0;
  for (const PlotPanel& panel : panels) {
    const Frame frame = frame_of(panel, height_px);
    draw_axes(body, panel, frame);
    for (const PlotCurve& curve : panel.curves) draw_curve(body, curve, frame);
    draw_legend(body, panel, frame);
    height_px = frame.bottom_px() + kBottom_px;
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n"
      "{2}<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{3}</svg>\n",
      kWidth_px, height_px, kStyle, body);
}

}  // namespace mlo
