#include "mlo/evaluation/trajectory_plots.hpp"

#include <utility>

namespace mlo {

std::vector<PlotPanel> trajectory_panels(std::span<const TrajectoryEvaluation> evaluations,
                                         GroundPlane plane) {
  const bool camera = plane == GroundPlane::xz;
  const auto project = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(p.x(), camera ? p.z() : p.y());
  };
  std::vector<PlotPanel> panels{
      {"Path seen from above, aligned", "x [m]", camera ? "z [m]" : "y [m]", true, {}},
      {"Position error after alignment", "frame", "[m]", false, {}},
      {"Translation error of each step (RTE)", "frame", "[m/frame]", false, {}},
      {"Rotation error of each step (RRE)", "frame", "[deg/frame]", false, {}}};
  for (std::size_t k = 0; k < evaluations.size(); ++k) {
    const auto& [name, matching, errors] = evaluations[k];
    if (k == 0) {
      PlotCurve truth{"truth", 0, {}};
      for (const PosePair& pair : matching.pairs)
        truth.points.push_back(project(pair.T_world_truth.translation()));
      panels[0].curves.push_back(std::move(truth));
    }
    std::vector<PlotCurve> curves(panels.size(), {name, k + 1, {}});
    for (std::size_t i = 0; i < matching.pairs.size(); ++i) {
      const PosePair& pair = matching.pairs[i];
      const auto frame = static_cast<double>(pair.frame);
      curves[0].points.push_back(project(errors.T_truth_estimate * pair.T_world_estimate.translation()));
      curves[1].points.emplace_back(frame, errors.position_errors_m[i]);
      if (i == 0) continue;
      curves[2].points.emplace_back(frame, errors.steps[i - 1].translation_m);
      curves[3].points.emplace_back(frame, errors.steps[i - 1].rotation_deg);
    }
    for (std::size_t i = 0; i < panels.size(); ++i) panels[i].curves.push_back(std::move(curves[i]));
  }
  return panels;
}

}  // namespace mlo
