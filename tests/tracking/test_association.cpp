#include <gtest/gtest.h>

#include "mlo/tracking/association.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

using test::car;
using test::kDegree;

struct Scene {
  std::vector<ObjectFilter> filters;
  std::vector<BoxMeasurement> measurements;
  std::vector<ObjectClass> track_classes;
  std::vector<ObjectClass> detection_classes;

  void add_track(const Detection& detection) {
    filters.emplace_back(measure(detection, SE3(), {}), true, ObjectMotionConfig{});
    track_classes.push_back(detection.object_class);
  }
  void add_detection(const Detection& detection) {
    measurements.push_back(measure(detection, SE3(), {}));
    detection_classes.push_back(detection.object_class);
  }
  std::vector<Assignment> pairs() const {
    std::vector<AssociationTrack> tracks;
    for (std::size_t i = 0; i < filters.size(); ++i) tracks.push_back({&filters[i], track_classes[i]});
    std::vector<AssociationDetection> detections;
    for (std::size_t i = 0; i < measurements.size(); ++i) {
      detections.push_back({&measurements[i], detection_classes[i]});
    }
    return associate(tracks, detections, {});
  }
};

TEST(Association, NothingToGiveOut) {
  Scene scene;
  EXPECT_TRUE(scene.pairs().empty());
  scene.add_track(car(10.0, 0.0));
  EXPECT_TRUE(scene.pairs().empty());
}

TEST(Association, TheGateHolds) {
  Scene scene;
  scene.add_track(car(10.0, 0.0));
  scene.add_detection(car(10.0, 8.0));
  EXPECT_TRUE(scene.pairs().empty());
}

TEST(Association, TheWholeCountsNotTheNearestPair) {
  // The second detection is nearest to the first track; giving it away there would leave a track without.
  Scene scene;
  scene.add_track(car(10.0, 0.0));
  scene.add_track(car(10.0, 1.0));
  scene.add_detection(car(10.0, -0.6));
  scene.add_detection(car(10.0, 0.45));
  const auto pairs = scene.pairs();
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].col, 0);
  EXPECT_EQ(pairs[1].col, 1);
}

TEST(Association, SizeDecidesBetweenEqualDistances) {
  Scene scene;
  Detection small = car(10.0, -0.5);
  Detection large = car(10.0, 0.5);
  large.box.size_lwh_m = {5.2, 2.0, 2.1};
  scene.add_track(small);
  scene.add_track(large);
  Detection seen = large;
  seen.box.center_lidar_m.y() = 0.0;
  scene.add_detection(seen);
  const auto pairs = scene.pairs();
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].row, 1);
}

TEST(Association, HeadingDecidesButNotItsFlip) {
  Scene scene;
  scene.add_track(car(10.0, -0.5, 90.0 * kDegree));
  scene.add_track(car(10.0, 0.5, 0.0));
  scene.add_detection(car(10.0, 0.0, 180.0 * kDegree));
  const auto pairs = scene.pairs();
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].row, 1);
}

TEST(Association, ClassesStayApartButVehiclesAreAlike) {
  EXPECT_TRUE(same_kind(ObjectClass::car, ObjectClass::van));
  EXPECT_FALSE(same_kind(ObjectClass::car, ObjectClass::pedestrian));
  Scene scene;
  scene.add_track(car(10.0, 0.0));
  Detection pedestrian = car(10.0, 0.0);
  pedestrian.object_class = ObjectClass::pedestrian;
  scene.add_detection(pedestrian);
  EXPECT_TRUE(scene.pairs().empty());
}

}  // namespace
}  // namespace mlo
