#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace mlo {

/// Points joined by straight lines; a point that is not finite leaves a gap.
struct PlotCurve {
  std::string name;
  std::size_t color = 0;  ///< index into the palette: 0 is dark grey, the others are colours, repeating
  std::vector<Eigen::Vector2d> points;
};

/// One diagram: axes with ticks, grid, labels (write the units into them) and curves.
struct PlotPanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  bool equal_scale = false;  ///< a unit is as long on x as on y, for maps
  std::vector<PlotCurve> curves;
};

/// The diagrams one below the other as a self-contained SVG document.
std::string svg_plot(std::span<const PlotPanel> panels);

}  // namespace mlo
