#include "mlo/learning/batch.hpp"

#include <algorithm>

#include "mlo/detection/network_input.hpp"

namespace mlo {

std::vector<Groups> group(const PointRows& points, const PointRows& centers,
                          const SetAbstractionSpec& layer) {
  std::vector<Groups> groups;
  for (const ScaleSpec& scale : layer.scales) {
    groups.push_back(query_balls(points, centers,
                                 {.inner_radius_m = static_cast<float>(scale.inner_radius_m),
                                  .radius_m = static_cast<float>(scale.radius_m),
                                  .neighbours = static_cast<std::size_t>(scale.neighbours)}));
  }
  return groups;
}

BatchExample make_batch_example(std::span<const Point> points, std::vector<TargetBox> boxes,
                                const NetworkArchitecture& architecture) {
  BatchExample example{network_input(points, architecture.input), std::move(boxes), {}};
  const SetAbstractionSpec& layer = architecture.layers.front();
  const bool needs_features = std::ranges::any_of(layer.samples, [](const SamplingSpec& sampling) {
    return sampling.method == SamplingSpec::Method::feature;
  });
  if (needs_features) return example;
  example.first_layer.centers = sample(example.input.points, example.input.features, layer.samples);
  const std::vector<std::uint32_t>& chosen = example.first_layer.centers;
  PointRows centers(static_cast<Eigen::Index>(chosen.size()), 3);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    centers.row(static_cast<Eigen::Index>(i)) = example.input.points.row(chosen[i]);
  }
  example.first_layer.scales = group(example.input.points, centers, layer);
  return example;
}

}  // namespace mlo
