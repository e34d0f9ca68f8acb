#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/report/birds_eye.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;
using testing::Not;

SE3 at(double x_m, double y_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, y_m, 0.0}};
}

ObjectPose object(long id, std::size_t frame, double x_m) {
  ObjectPose pose;
  pose.id = id;
  pose.frame = frame;
  pose.T_map_object = at(x_m, 2.0);
  return pose;
}

TEST(BirdsEye, KeepsItsScaleAndDrawsPathAndScale) {
  const std::vector<SE3> path{at(0.0, 0.0), at(60.0, 10.0)};
  const std::string svg =
      birds_eye_svg({}, path, {}, {.width_px = 1000, .max_height_px = 1000, .margin_m = 20.0});
  // 100 m by 50 m in 1000 by 500 pixels; x to the right, y up.
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 1000 500\""));
  EXPECT_THAT(svg, HasSubstr("points=\"200.0,300.0 800.0,200.0 \""));
  EXPECT_THAT(svg, HasSubstr("20 m</text>"));
  EXPECT_THAT(svg, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
}

TEST(BirdsEye, MovingObjectsAreWaysOthersDots) {
  const std::vector<SE3> path{at(0.0, 0.0), at(60.0, 10.0)};
  std::vector<ObjectPose> objects;
  for (std::size_t frame = 0; frame < 5; ++frame) {
    objects.push_back(object(1, frame, 3.0 * static_cast<double>(frame)));
    objects.push_back(object(2, frame, 10.0));
  }
  const std::string svg = birds_eye_svg({}, path, objects);
  EXPECT_THAT(svg, HasSubstr("#d55e00"));
  EXPECT_THAT(svg, HasSubstr("#009e73"));
  EXPECT_THAT(birds_eye_svg({}, path, {}), Not(HasSubstr("#d55e00")));
}

TEST(BirdsEye, TheMapChangesTheImage) {
  const std::vector<SE3> path{at(0.0, 0.0), at(10.0, 0.0)};
  const std::vector<MapPoint> map{{{5.0F, 5.0F, 1.0F}, 0.0F, MapLabel::surface},
                                  {{std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F}, 0.0F, {}},
                                  {{1e9F, 0.0F, 0.0F}, 0.0F, MapLabel::ground}};
  EXPECT_NE(birds_eye_svg(map, path, {}), birds_eye_svg({}, path, {}));
  EXPECT_EQ(birds_eye_svg({&map[1], 2}, path, {}), birds_eye_svg({}, path, {}));  // neither is in the picture
}

TEST(BirdsEye, NothingAndOnePose) {
  EXPECT_EQ(birds_eye_svg({}, {}, {}), "");
  EXPECT_EQ(birds_eye_svg({}, std::vector<SE3>{at(std::numeric_limits<double>::quiet_NaN(), 0.0)}, {}), "");
  EXPECT_THAT(birds_eye_svg({}, std::vector<SE3>{at(1.0, 1.0)}, {}), HasSubstr("<svg"));
}

}  // namespace
}  // namespace mlo
