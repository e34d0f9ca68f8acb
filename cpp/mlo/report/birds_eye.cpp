#include "mlo/report/birds_eye.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "mlo/core/bytes.hpp"
#include "mlo/report/png.hpp"

namespace mlo {
namespace {

constexpr double kShortestScale_m = 1.0;
constexpr double kMovingPath_m = 3.0;  // an object that goes farther is drawn as a way

struct Canvas {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();  // [m]
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  double px_per_m = 1.0;
  std::size_t width = 0;
  std::size_t height = 0;

  Eigen::Vector2d px(const Eigen::Vector2d& p) const {
    return {(p.x() - min.x()) * px_per_m, (max.y() - p.y()) * px_per_m};
  }
};

Canvas canvas_around(std::span<const SE3> path, const BirdsEyeOptions& options) {
  Canvas canvas;
  bool first = true;
  for (const SE3& pose : path) {
    if (!pose.is_finite()) continue;
    const Eigen::Vector2d p = pose.translation().head<2>();
    canvas.min = first ? p : Eigen::Vector2d(canvas.min.cwiseMin(p));
    canvas.max = first ? p : Eigen::Vector2d(canvas.max.cwiseMax(p));
    first = false;
  }
  if (first) return canvas;
  canvas.min.array() -= options.margin_m;
  canvas.max.array() += options.margin_m;
  const Eigen::Vector2d size = canvas.max - canvas.min;
  canvas.px_per_m = std::min(static_cast<double>(options.width_px) / size.x(),
                             static_cast<double>(options.max_height_px) / size.y());
  canvas.width = static_cast<std::size_t>(std::ceil(size.x() * canvas.px_per_m));
  canvas.height = static_cast<std::size_t>(std::ceil(size.y() * canvas.px_per_m));
  return canvas;
}

// Ground makes a pixel light grey, what stands on it darker with each point.
std::vector<std::uint8_t> shades(std::span<const MapPoint> map, const Canvas& canvas) {
  constexpr std::uint8_t kWhite = 15;
  constexpr std::uint8_t kGround = 13;
  constexpr std::uint8_t kStep = 3;
  std::vector<std::uint8_t> image(canvas.width * canvas.height, kWhite);
  for (const MapPoint& point : map) {
    const Eigen::Vector2d px = canvas.px(point.p_map.head<2>().cast<double>());
    if (!(px.x() >= 0.0 && px.y() >= 0.0)) continue;
    const auto x = static_cast<std::size_t>(px.x());
    const auto y = static_cast<std::size_t>(px.y());
    if (x >= canvas.width || y >= canvas.height) continue;
    std::uint8_t& shade = image[y * canvas.width + x];
    if (point.label == MapLabel::ground) {
      shade = std::min(shade, kGround);
    } else {
      shade = static_cast<std::uint8_t>(std::max(0, std::min<int>(shade, kGround - 1) - kStep));
    }
  }
  return image;
}

void draw_line(std::string& svg, const std::vector<Eigen::Vector2d>& points, const char* style) {
  svg += "<polyline points=\"";
  for (const Eigen::Vector2d& p : points) {
    fmt::format_to(std::back_inserter(svg), "{:.1f},{:.1f} ", p.x(), p.y());
  }
  fmt::format_to(std::back_inserter(svg), "\" fill=\"none\" {}/>\n", style);
}

void draw_objects(std::string& svg, std::span<const ObjectPose> objects, const Canvas& canvas) {
  std::map<long, std::vector<Eigen::Vector2d>> ways;  // [m]
  for (const ObjectPose& object : objects) {
    if (object.T_map_object.is_finite()) {
      ways[object.id].push_back(object.T_map_object.translation().head<2>());
    }
  }
  for (const auto& [id, way] : ways) {
    const bool moves = (way.back() - way.front()).norm() > kMovingPath_m;
    std::vector<Eigen::Vector2d> line;
    for (const Eigen::Vector2d& p : way) line.push_back(canvas.px(p));
    if (moves) {
      draw_line(svg, line, "stroke=\"#d55e00\" stroke-width=\"1.5\"");
    } else {
      fmt::format_to(std::back_inserter(svg),
                     "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"#009e73\"/>\n", line.back().x(),
                     line.back().y());
    }
  }
}

// A round length of about a fifth of the width.
void draw_scale(std::string& svg, const Canvas& canvas) {
  const double wanted_m =
      std::max(kShortestScale_m, 0.2 * static_cast<double>(canvas.width) / canvas.px_per_m);
  const double power = std::pow(10.0, std::floor(std::log10(wanted_m)));
  const double length_m =
      wanted_m >= 5.0 * power ? 5.0 * power : (wanted_m >= 2.0 * power ? 2.0 * power : power);
  const double y = static_cast<double>(canvas.height) - 14.0;
  draw_line(svg, {{14.0, y}, {14.0 + length_m * canvas.px_per_m, y}}, "stroke=\"#222\" stroke-width=\"3\"");
  fmt::format_to(std::back_inserter(svg), "<text x=\"14\" y=\"{:.1f}\">{:g} m</text>\n", y - 8.0, length_m);
}

}  // namespace

std::string birds_eye_svg(std::span<const MapPoint> map, std::span<const SE3> path,
                          std::span<const ObjectPose> objects, const BirdsEyeOptions& options) {
  const Canvas canvas = canvas_around(path, options);
  if (canvas.width == 0 || canvas.height == 0) return {};
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<image width=\"{0}\" height=\"{1}\" href=\"data:image/png;base64,{2}\"/>\n",
      canvas.width, canvas.height, base64(png_of(shades(map, canvas), canvas.width, canvas.height)));
  draw_objects(svg, objects, canvas);
  std::vector<Eigen::Vector2d> line;
  for (const SE3& pose : path) {
    if (pose.is_finite()) line.push_back(canvas.px(pose.translation().head<2>()));
  }
  draw_line(svg, line, "stroke=\"#0072b2\" stroke-width=\"2.5\"");
  fmt::format_to(std::back_inserter(svg), "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"#0072b2\"/>\n",
                 line.front().x(), line.front().y());
  draw_scale(svg, canvas);
  return svg + "</svg>\n";
}

}  // namespace mlo
