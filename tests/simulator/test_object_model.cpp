#include <vector>

#include <gtest/gtest.h>

#include "mlo/simulator/mesh.hpp"
#include "mlo/simulator/object_model.hpp"

namespace mlo::simulator {
namespace {

std::vector<ObjectModel> all_models() {
  std::vector<ObjectModel> models{make_carriage(25.0)};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const auto make : {make_car, make_van, make_truck, make_pedestrian, make_cyclist}) {
      models.push_back(make(Random(seed)));
    }
  }
  return models;
}

TEST(ObjectModel, BoxHoldsTheShapeInEveryPhaseAndIsNoLargerThanNeeded) {
  for (const ObjectModel& model : all_models()) {
    Eigen::AlignedBox3d reached;
    for (double travelled = 0.0; travelled < 3.0; travelled += 0.05) {
      for (const ModelPart& part : model.parts) {
        reached.extend(transformed(part.T_ground_part(travelled), part.mesh).bounds());
      }
    }
    const Eigen::Vector3d half = 0.5 * model.size_lwh_m;
    const Eigen::Vector3d center(0.0, 0.0, half.z());
    constexpr double kTolerance = 0.03;
    EXPECT_TRUE(((reached.max() - center - half).array() < 1e-4).all());
    EXPECT_TRUE(((center - half - reached.min()).array() < 1e-4).all());
    EXPECT_TRUE(((reached.sizes() - model.size_lwh_m).array().abs() < kTolerance).all())
        << reached.sizes().transpose();
  }
}

TEST(ObjectModel, SizesAreThoseOfStreets) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Eigen::Vector3d car = make_car(Random(seed)).size_lwh_m;
    EXPECT_GT(car.x(), 3.4);
    EXPECT_LT(car.x(), 5.0);
    EXPECT_NEAR(car.y(), 1.75, 0.2);
    EXPECT_NEAR(car.z(), 1.5, 0.15);
    const Eigen::Vector3d person = make_pedestrian(Random(seed)).size_lwh_m;
    EXPECT_LT(person.x(), 1.4);
    EXPECT_NEAR(person.z(), 1.75, 0.3);
  }
}

TEST(ObjectModel, LegsSwingAgainstEachOther) {
  const ObjectModel person = make_pedestrian(Random(1));
  ASSERT_EQ(person.parts.size(), 5U);
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitX();
  const double quarter = 0.25 / person.parts[1].cycles_per_m;
  const double left = (person.parts[1].T_ground_part(quarter).rotation() * ahead).z();
  const double right = (person.parts[3].T_ground_part(quarter).rotation() * ahead).z();
  EXPECT_NEAR(left, -right, 1e-9);
  EXPECT_GT(std::abs(left), 0.2);
}

TEST(Mesh, CuboidTubeAndEllipsoidHaveTheirMeasures) {
  const Eigen::AlignedBox3d box = cuboid({-1, -2, 0}, {1, 2, 3}, Surface::wall).bounds();
  EXPECT_NEAR((box.sizes() - Eigen::Vector3d(2, 4, 3)).norm(), 0.0, 1e-6);
  const Eigen::AlignedBox3d rod = tube({0, 0, 0}, {0, 0, 5}, 0.5, 0.5, Surface::pole, 16).bounds();
  EXPECT_NEAR((rod.sizes() - Eigen::Vector3d(1, 1, 5)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(ellipsoid({1, 1, 1}, {1, 2, 3}, Surface::skin).bounds().sizes().z(), 6.0, 0.02);
}

TEST(Mesh, AppendingKeepsTrianglesTogether) {
  Mesh mesh = cuboid({0, 0, 0}, {1, 1, 1}, Surface::wall);
  const std::size_t triangles = mesh.triangles.size();
  mesh += cuboid({5, 5, 5}, {6, 6, 6}, Surface::roof);
  ASSERT_EQ(mesh.triangles.size(), 2 * triangles);
  for (const std::uint32_t corner : mesh.triangles.back().corners) {
    EXPECT_GE(mesh.vertices.at(corner).minCoeff(), 5.0F);
  }
}

TEST(Mesh, LoftOfNothingIsEmpty) {
  const auto surface = [](std::size_t, std::size_t) { return Surface::wall; };
  EXPECT_TRUE(loft({}, true, surface).triangles.empty());
  EXPECT_TRUE(Mesh{}.bounds().isEmpty());
}

}  // namespace
}  // namespace mlo::simulator
