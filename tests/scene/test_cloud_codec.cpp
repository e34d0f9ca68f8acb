#include <cmath>

#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/scene/cloud_codec.hpp"

namespace mlo {
namespace {

constexpr double kStep_m = 1.0 / 256.0;

SceneCloud decoded(const SceneCloud& cloud, const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
  return decode_cloud(encode_cloud(cloud, origin, kStep_m), "test");
}

SceneCloud random_cloud(float radius_m) {
  std::srand(7);
  SceneCloud cloud;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f p = radius_m * Eigen::Vector3f::Random();
    cloud.add({p, 0.5F}, i % 100 < 50 ? MapLabel::edge : MapLabel::object, i % 100 < 50 ? 0 : i / 100);
  }
  return cloud;
}

TEST(CloudCodec, PointsComeBackToHalfAStep) {
  const SceneCloud cloud = random_cloud(120.0F);
  const SceneCloud back = decoded(cloud);
  ASSERT_EQ(back.points.size(), cloud.points.size());
  EXPECT_EQ(back.groups, cloud.groups);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_LT((back.points[i].p - cloud.points[i].p).cwiseAbs().maxCoeff(), 0.51 * kStep_m);
    EXPECT_NEAR(back.points[i].intensity, cloud.points[i].intensity, 0.5 / 255.0 + 1e-6);
  }
}

TEST(CloudCodec, FarPointsGetACoarserStepAndStayRight) {
  const SceneCloud cloud = random_cloud(1000.0F);  // beyond 32767 steps
  const SceneCloud back = decoded(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_LT((back.points[i].p - cloud.points[i].p).cwiseAbs().maxCoeff(), 4.1 * kStep_m);
  }
}

TEST(CloudCodec, AnOriginFarAwayCostsNoDetail) {
  const Eigen::Vector3d origin(5000.0, -3000.0, 100.0);
  SceneCloud cloud = random_cloud(10.0F);
  for (ScenePoint& point : cloud.points) point.p += origin.cast<float>();
  const SceneCloud back = decoded(cloud, origin);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_LT((back.points[i].p - cloud.points[i].p).cwiseAbs().maxCoeff(), 0.51 * kStep_m + 5e-4);
  }
}

TEST(CloudCodec, IntensitiesBeyondOneKeepTheirScale) {
  SceneCloud cloud;
  cloud.add({Eigen::Vector3f::Zero(), 250.0F}, MapLabel::unknown);
  cloud.add({Eigen::Vector3f::Zero(), 100.0F}, MapLabel::unknown);
  cloud.add({Eigen::Vector3f::Zero(), -1.0F}, MapLabel::unknown);
  const SceneCloud back = decoded(cloud);
  EXPECT_NEAR(back.points[0].intensity, 250.0F, 0.01F);
  EXPECT_NEAR(back.points[1].intensity, 100.0F, 0.5F);
  EXPECT_EQ(back.points[2].intensity, 0.0F);
}

TEST(CloudCodec, EmptyAndSingle) {
  EXPECT_TRUE(decoded({}).points.empty());
  SceneCloud one;
  one.add({{1.0F, 2.0F, 3.0F}, 0.0F}, MapLabel::surface);
  EXPECT_EQ(decoded(one).points.at(0).p, one.points[0].p);
}

TEST(CloudCodec, DamagedBytesAreAnInputError) {
  const std::string bytes = encode_cloud(random_cloud(10.0F), Eigen::Vector3d::Zero(), kStep_m);
  for (std::size_t size = 0; size < bytes.size(); size += 37) {
    EXPECT_THROW(decode_cloud(std::string_view(bytes).substr(0, size), "test"), InputError);
  }
}

TEST(CloudCodec, GroupsAreRunsOfTheSameKind) {
  SceneCloud cloud;
  for (int i = 0; i < 3; ++i) cloud.add({}, MapLabel::edge);
  cloud.add({}, MapLabel::object, 1);
  cloud.add({}, MapLabel::object, 2);
  const std::vector<PointGroup> expected{
      {MapLabel::edge, 0, 3}, {MapLabel::object, 1, 1}, {MapLabel::object, 2, 1}};
  EXPECT_EQ(cloud.groups, expected);
}

}  // namespace
}  // namespace mlo
