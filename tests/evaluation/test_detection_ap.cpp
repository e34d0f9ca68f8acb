#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "mlo/evaluation/detection_ap.hpp"

namespace mlo {
namespace {

const Eigen::Vector3d kCarSize(4.0, 1.8, 1.5);
const DetectionProtocol kCars{.object_class = "car", .overlap = BoxOverlap::volume, .min_overlap = 0.7};

Box3d car_at(double x_m, double y_m = 0.0, double z_m = 0.0) {
  return {{x_m, y_m, z_m}, kCarSize, 0.0};
}

LabelledBox label(const Box3d& box, const std::string& type = "car") {
  return {.type = type, .box = box, .height_px = 50.0};
}

ScoredBox scored(const Box3d& box, double confidence) {
  return {.type = "car", .box = box, .confidence = confidence, .height_px = 50.0};
}

/// So many cars in a row, far apart.
DetectionFrame row_of_cars(int count) {
  DetectionFrame frame;
  for (int i = 0; i < count; ++i) frame.truth.push_back(label(car_at(10.0 * i)));
  return frame;
}

double moderate_ap(const DetectionFrame& frame, const DetectionProtocol& protocol = kCars) {
  return average_precision({&frame, 1}, protocol, Difficulty::moderate).ap;
}

TEST(AveragePrecision, OfAHandComputedCase) {
  // 40 cars, the first 20 of them found; a false alarm is surer than ten of them.
  DetectionFrame frame = row_of_cars(40);
  for (int i = 0; i < 20; ++i) frame.detections.push_back(scored(car_at(10.0 * i), 0.9 - 0.01 * i));
  frame.detections.push_back(scored(car_at(0.0, 50.0), 0.9 - 0.095));
  const AveragePrecision result = average_precision({&frame, 1}, kCars, Difficulty::moderate);
  EXPECT_EQ(result.num_truth, 40U);
  EXPECT_DOUBLE_EQ(result.recall, 0.5);
  // Each of the 20 matches is a threshold; the first stands for recall 0. Nine more have precision 1, ten at
  // best 20/21, and recall above 20/40 is never reached.
  EXPECT_NEAR(result.ap, (9.0 + 10.0 * 20.0 / 21.0) / 40.0, 1e-12);
}

TEST(AveragePrecision, PerfectAndEmpty) {
  DetectionFrame frame = row_of_cars(100);
  EXPECT_EQ(moderate_ap(frame), 0.0);
  for (int i = 0; i < 100; ++i) frame.detections.push_back(scored(car_at(10.0 * i), 0.001 * i));
  EXPECT_NEAR(moderate_ap(frame), 1.0, 1e-12);
  const DetectionFrame nothing;
  EXPECT_EQ(moderate_ap(nothing), 0.0);
  EXPECT_EQ(average_precision({}, kCars, Difficulty::hard).num_truth, 0U);
  DetectionFrame only_false = nothing;
  only_false.detections.push_back(scored(car_at(5.0), 1.0));
  EXPECT_EQ(moderate_ap(only_false), 0.0);
}

TEST(AveragePrecision, LeavesOutWhatTheBenchmarkDoes) {
  DetectionFrame frame = row_of_cars(100);
  for (int i = 0; i < 100; ++i) frame.detections.push_back(scored(car_at(10.0 * i), 0.5));
  // Beside them: a van, cars too small, too hidden, cut off by the image; a detection too small to count.
  const auto add = [&](double y_m, LabelledBox box) {
    box.box.center_lidar_m.y() = y_m;
    frame.truth.push_back(box);
    frame.detections.push_back(scored(box.box, 0.9));
  };
  add(100.0, label(car_at(0.0), "van"));
  LabelledBox hard = label(car_at(0.0));
  hard.height_px = 24.0;
  add(110.0, hard);
  hard = label(car_at(0.0));
  hard.occlusion = 2;
  add(120.0, hard);
  hard.occlusion = 0;
  hard.truncation = 2;
  add(130.0, hard);
  frame.detections.push_back(scored(car_at(0.0, 140.0), 0.9));
  frame.detections.back().height_px = 10.0;
  EXPECT_NEAR(moderate_ap(frame), 1.0, 1e-12);
  EXPECT_EQ(average_precision({&frame, 1}, kCars, Difficulty::hard).num_truth, 101U);
  // Another class is neither truth nor neighbour: what lies on it is a false alarm.
  frame.truth.push_back(label(car_at(0.0, 150.0), "truck"));
  frame.detections.push_back(scored(car_at(0.0, 150.0), 0.9));
  EXPECT_LT(moderate_ap(frame), 1.0);
}

TEST(AveragePrecision, CountsOneOfTwoBoxesOnACar) {
  DetectionFrame frame = row_of_cars(100);
  for (int i = 0; i < 100; ++i) {
    frame.detections.push_back(scored(car_at(10.0 * i), 0.5));
    frame.detections.push_back(scored(car_at(10.0 * i, 0.05), 0.5));
  }
  EXPECT_NEAR(moderate_ap(frame), 0.5, 1e-12);
}

TEST(AveragePrecision, SeenFromAboveHeightsDoNotMatter) {
  DetectionFrame frame = row_of_cars(100);
  for (int i = 0; i < 100; ++i) frame.detections.push_back(scored(car_at(10.0 * i, 0.0, 5.0), 0.5));
  EXPECT_EQ(moderate_ap(frame), 0.0);
  DetectionProtocol from_above = kCars;
  from_above.overlap = BoxOverlap::footprint;
  EXPECT_NEAR(moderate_ap(frame, from_above), 1.0, 1e-12);
}

// The benchmark's definition without its tricks, for boxes that meet at most one other: precision at the rank
// of each match, its best from there on, sampled where the recall is nearest to k / 40. The last match stands
// for the level after its own, too.
double plain_ap(std::vector<std::pair<double, bool>> ranked, int num_truth) {
  std::sort(ranked.rbegin(), ranked.rend());
  std::vector<double> precision;
  int found = 0;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (ranked[i].second) precision.push_back(static_cast<double>(++found) / static_cast<double>(i + 1));
  }
  for (std::size_t i = precision.size() - 1; i > 0; --i) {
    precision[i - 1] = std::max(precision[i - 1], precision[i]);
  }
  double sum = 0.0;
  for (int k = 1; k <= 40; ++k) {
    const auto rank = static_cast<std::size_t>(std::lround(k / 40.0 * num_truth));
    const auto rank_before = static_cast<std::size_t>(std::lround((k - 1) / 40.0 * num_truth));
    if (rank_before < precision.size()) sum += precision[std::min(rank, precision.size()) - 1];
  }
  return sum / 40.0;
}

TEST(AveragePrecision, EqualsThePlainDefinition) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int repeat = 0; repeat < 20; ++repeat) {
    DetectionFrame frame = row_of_cars(400);
    std::vector<std::pair<double, bool>> ranked;
    for (int i = 0; i < 400; ++i) {
      if (uniform(rng) < 0.2) continue;
      ranked.emplace_back(uniform(rng), true);
      frame.detections.push_back(scored(car_at(10.0 * i), ranked.back().first));
    }
    for (int i = 0; i < 150; ++i) {
      ranked.emplace_back(uniform(rng) * uniform(rng), false);
      frame.detections.push_back(scored(car_at(10.0 * i, 100.0), ranked.back().first));
    }
    EXPECT_NEAR(moderate_ap(frame), plain_ap(ranked, 400), 2e-3);
  }
}

TEST(RecallByRange, CountsEachBin) {
  DetectionFrame frame = row_of_cars(6);  // at 0, 10 ... 50 m
  for (const double x_m : {0.0, 20.0, 30.0}) frame.detections.push_back(scored(car_at(x_m), 0.1 * x_m));
  const std::vector<double> borders_m{0.0, 15.0, 30.0, 100.0};
  const auto bins = recall_by_range({&frame, 1}, kCars, Difficulty::hard, borders_m, 0.0);
  ASSERT_EQ(bins.size(), 3U);
  EXPECT_EQ(bins[0].truth, 2U);
  EXPECT_EQ(bins[0].found, 1U);
  EXPECT_EQ(bins[1].truth, 1U);
  EXPECT_EQ(bins[1].found, 1U);
  EXPECT_EQ(bins[2].truth, 3U);
  EXPECT_EQ(bins[2].found, 1U);
  const auto sure = recall_by_range({&frame, 1}, kCars, Difficulty::hard, borders_m, 2.5);
  EXPECT_EQ(sure[0].found + sure[1].found, 0U);
  EXPECT_EQ(sure[2].found, 1U);
}

}  // namespace
}  // namespace mlo
