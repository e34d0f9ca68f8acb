#include "mlo/reproduction/runs.hpp"

#include <nlohmann/json.hpp>

#include "mlo/io/text.hpp"
#include "mlo/pipeline/run.hpp"

namespace mlo {
namespace {

bool is_finished(const std::filesystem::path& folder, std::size_t scans) {
  const std::filesystem::path file = folder / "run.json";
  if (!std::filesystem::exists(file)) return false;
  const auto json = nlohmann::json::parse(read_file(file), nullptr, false);
  return json.is_object() && !json.value("interrupted", true) && json.value("version", "") == MLO_VERSION &&
         json.value("scans", std::size_t{0}) == scans;
}

}  // namespace

std::size_t scans_up_to(const Dataset& dataset, std::size_t last_frame) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i)
    count += dataset.scans->frame(i) <= last_frame ? 1 : 0;
  return count;
}

bool run_unless_finished(const Dataset& dataset, const std::optional<DetectionList>& detections,
                         const Variant& variant, const std::filesystem::path& folder,
                         const ReproduceOptions& options, const ReproduceProgress& progress) {
  if (is_finished(folder, scans_up_to(dataset, options.last_frame))) return true;
  PipelineConfig base;
  base.sensor = dataset.sensor;
  base.detection.detector = Detector::none;  // boxes are the published ones, or there are none
  const PipelineConfig config = resolve({.presets = variant.presets, .settings = variant.settings}, base);
  const RunSummary summary =
      run(dataset, detections, config, {.out = folder, .last_frame = options.last_frame}, progress.on_scan,
          progress.should_stop);
  return !summary.interrupted;
}

}  // namespace mlo
