#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/perception/fusion.hpp"
#include "mlo/perception/objects.hpp"

namespace mlo {
namespace {

using testing::ElementsAre;

Point at(float x, float y, float z) {
  Point point;
  point.p_lidar = Eigen::Vector3f(x, y, z);
  return point;
}

Detection detection(const Eigen::Vector3d& center, const Eigen::Vector3d& size, double yaw,
                    double confidence) {
  return {.box = {center, size, yaw}, .confidence = confidence};
}

TEST(LabelObjects, AgreesWithTestingEveryBox) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Detection> detections;
  for (int k = 0; k < 30; ++k) {
    detections.push_back(detection({15.0 * uniform(random), 15.0 * uniform(random), uniform(random)},
                                   {3.0 + uniform(random), 2.0 + uniform(random), 2.0}, 3.0 * uniform(random),
                                   0.1 * (k % 7)));
  }
  std::vector<Point> points;
  for (int i = 0; i < 20000; ++i) {
    points.push_back(at(static_cast<float>(16.0 * uniform(random)),
                        static_cast<float>(16.0 * uniform(random)),
                        static_cast<float>(2.0 * uniform(random))));
  }
  const std::vector<std::uint16_t> ids = label_objects(points, detections, 0.15);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].p_lidar.cast<double>();
    std::uint16_t best = kNoObject;
    for (std::size_t k = 0; k < detections.size(); ++k) {
      if (!detections[k].box.contains(p, 0.15)) continue;
      const auto rank = [&](std::size_t j) {
        return std::pair(-detections[j].confidence, (detections[j].box.center_lidar_m - p).norm());
      };
      if (best == kNoObject || rank(k) < rank(best)) best = static_cast<std::uint16_t>(k);
    }
    ASSERT_EQ(ids[i], best) << i;
    inside += best != kNoObject;
  }
  EXPECT_GT(inside, 1000U);
}

TEST(LabelObjects, OverlapsGoToTheMostConfidentThenTheNearer) {
  const std::vector<Point> points{at(1.0F, 0.0F, 0.0F), at(2.4F, 0.0F, 0.0F)};
  const Detection left = detection({0.0, 0.0, 0.0}, {6.0, 2.0, 2.0}, 0.0, 0.8);
  Detection right = detection({3.0, 0.0, 0.0}, {6.0, 2.0, 2.0}, 0.0, 0.8);
  EXPECT_THAT(label_objects(points, std::vector{left, right}, 0.0), ElementsAre(0, 1));
  right.confidence = 0.9;
  EXPECT_THAT(label_objects(points, std::vector{left, right}, 0.0), ElementsAre(1, 1));
}

TEST(LabelObjects, BoxesThatAreNotFiniteHoldNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Point> points{at(0.0F, 0.0F, 0.0F)};
  const std::vector<Detection> broken{detection({nan, 0.0, 0.0}, {4.0, 2.0, 2.0}, 0.0, 1.0),
                                      detection({0.0, 0.0, 0.0}, {4.0, nan, 2.0}, 0.0, 1.0),
                                      detection({0.0, 0.0, 0.0}, {4.0, 2.0, 2.0}, nan, 1.0)};
  EXPECT_THAT(label_objects(points, broken, 0.1), ElementsAre(kNoObject));
}

TEST(LabelObjects, WithoutPointsOrBoxes) {
  EXPECT_TRUE(label_objects({}, std::vector<Detection>(2), 0.1).empty());
  EXPECT_THAT(label_objects(std::vector<Point>(2), {}, 0.1), ElementsAre(kNoObject, kNoObject));
}

TEST(MutualCorrection, PointsThatAreBothTakeNoPart) {
  const std::vector<std::uint8_t> is_ground{0, 1, 0, 1};
  const std::vector<std::uint16_t> ids{kNoObject, kNoObject, 1, 1};
  const std::vector<PointKind> kinds = correct_mutually(is_ground, ids);
  EXPECT_THAT(kinds,
              ElementsAre(PointKind::background, PointKind::ground, PointKind::object, PointKind::ambiguous));
  const std::vector<Point> points{at(0.0F, 0.0F, 0.0F), at(1.0F, 0.0F, 0.0F), at(2.0F, 0.0F, 0.0F),
                                  at(3.0F, 0.0F, 0.0F)};
  const std::vector<std::vector<Point>> objects = collect_objects(points, kinds, ids, 2);
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_TRUE(objects[0].empty());
  ASSERT_EQ(objects[1].size(), 1U);
  EXPECT_EQ(objects[1][0].p_lidar.x(), 2.0F);
}

}  // namespace
}  // namespace mlo
