#include <gtest/gtest.h>

#include "mlo/core/box.hpp"

namespace mlo {
namespace {

TEST(Box3d, ContainsWhatIsInside) {
  const Box3d box{{10.0, 5.0, -1.0}, {4.0, 2.0, 1.5}, 0.5};
  const SE3 T = box.T_lidar_object();
  EXPECT_TRUE(box.contains(T * Eigen::Vector3d(1.99, 0.99, 0.74)));
  EXPECT_FALSE(box.contains(T * Eigen::Vector3d(2.01, 0.0, 0.0)));
  EXPECT_FALSE(box.contains(T * Eigen::Vector3d(0.0, -1.01, 0.0)));
  EXPECT_FALSE(box.contains(T * Eigen::Vector3d(0.0, 0.0, 0.76)));
  EXPECT_TRUE(box.contains(T * Eigen::Vector3d(2.05, 0.0, 0.0), 0.1));
}

TEST(ObjectClass, NamesRoundTrip) {
  for (const auto c : {ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::pedestrian,
                       ObjectClass::cyclist, ObjectClass::other}) {
    EXPECT_EQ(object_class_from(to_string(c)), c);
  }
  EXPECT_EQ(object_class_from("Pedestrian"), ObjectClass::pedestrian);
  EXPECT_EQ(object_class_from("Tram"), ObjectClass::other);
  EXPECT_FALSE(object_class_from("DontCare").has_value());
}

}  // namespace
}  // namespace mlo
