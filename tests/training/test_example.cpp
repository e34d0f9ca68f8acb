#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "made_example.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/training/example.hpp"

namespace mlo {
namespace {

using test::made_label;
using test::made_points;

/// A camera at the lidar that looks ahead.
LabelledView view_ahead() {
  LabelledView view;
  view.T_camera0_lidar = T_camera0_level();
  view.P2 << 700.0, 0.0, 621.0, 0.0, 0.0, 700.0, 187.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return view;
}

TEST(Example, CountsPointsAndDemandsWhatHasEnough) {
  const std::vector<LabelledBox> labels{made_label("car", 10.0, 5.0, 0.3)};
  const TrainingExample example = make_example("x", made_points(labels, 1, 5, 0), labels, std::nullopt, 5);
  ASSERT_EQ(example.boxes.size(), 1U);
  EXPECT_EQ(example.boxes[0].points, 5U);
  EXPECT_TRUE(example.boxes[0].demanded);
  EXPECT_EQ(example.boxes[0].object_class, ObjectClass::car);
  EXPECT_FALSE(make_example("x", made_points(labels, 1, 4, 0), labels, std::nullopt, 5).boxes[0].demanded);
}

TEST(Example, TakesAnyTypeAndKeepsItsName) {
  std::vector<LabelledBox> labels{made_label("pedestrian", 5.0, 0.0, 0.0), made_label("car", 15.0, 0.0, 0.0)};
  labels[0].type = "person";
  labels[1].type = "spaceship";
  const TrainingExample example = make_example("x", {}, labels, std::nullopt, 0);
  EXPECT_EQ(example.boxes[0].object_class, ObjectClass::pedestrian);
  EXPECT_EQ(example.boxes[0].type, "person");
  EXPECT_EQ(example.boxes[1].object_class, ObjectClass::other);
}

TEST(Example, LeavesOutWhatIsNotFiniteOrHasNoVolume) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::vector<LabelledBox> labels(5, made_label("car", 10.0, 5.0, 0.0));
  labels[1].box.center_lidar_m.x() = kNaN;
  labels[2].box.yaw_rad = std::numeric_limits<double>::infinity();
  labels[3].box.size_lwh_m.y() = 0.0;
  labels[4].box.size_lwh_m.z() = -1.0;
  std::vector<Point> points(3);
  points[0].p_lidar = {1.0F, 2.0F, std::numeric_limits<float>::quiet_NaN()};
  points[1].p_lidar = {std::numeric_limits<float>::infinity(), 2.0F, 0.0F};
  const TrainingExample example = make_example("x", points, labels, std::nullopt, 0);
  EXPECT_EQ(example.boxes.size(), 1U);
  EXPECT_EQ(example.points.size(), 1U);
}

TEST(Example, OfNothing) {
  const TrainingExample example = make_example("x", {}, {}, std::nullopt, 5);
  EXPECT_TRUE(example.points.empty());
  EXPECT_TRUE(example.boxes.empty());
}

TEST(Example, KeepsThePointsThatTheImageShows) {
  const LabelledView view = view_ahead();
  EXPECT_TRUE(shows(view, {10.0, 0.0, 0.0}));
  EXPECT_FALSE(shows(view, {-10.0, 0.0, 0.0}));
  EXPECT_FALSE(shows(view, {10.0, 10.0, 0.0}));  // 700 px to the left of the middle
  EXPECT_TRUE(shows(view, {10.0, 8.8, 0.0}));    // 616 px
  EXPECT_FALSE(shows(view, {10.0, 0.0, 3.0}));   // 210 px above
  EXPECT_FALSE(shows(view, {0.0, 0.0, 0.0}));
  std::vector<Point> points(2);
  points[0].p_lidar = {10.0F, 0.0F, 0.0F};
  points[1].p_lidar = {-10.0F, 0.0F, 0.0F};
  EXPECT_EQ(make_example("x", points, {}, view, 5).points.size(), 1U);
}

}  // namespace
}  // namespace mlo
