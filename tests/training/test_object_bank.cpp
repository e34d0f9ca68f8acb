#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "made_example.hpp"
#include "mlo/core/box_overlap.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/training/object_bank.hpp"

namespace mlo {
namespace {

using test::kGroundZ_m;
using test::made_example;
using test::made_label;
using test::made_points;
using test::made_street;

ObjectBank bank_of_streets(int count, ObjectBankLimits limits = {}) {
  ObjectBank bank(limits);
  for (int i = 0; i < count; ++i) bank.add(made_street(static_cast<std::uint64_t>(100 + i)));
  return bank;
}

TEST(ObjectBank, TakesDemandedObjectsThatStandAlone) {
  const std::vector<LabelledBox> labels{made_label("car", 10.0, 0.0, 0.0), made_label("car", 20.0, 0.0, 0.0),
                                        made_label("car", 22.0, 1.0, 0.5)};  // the last two share ground
  TrainingExample example = made_example(labels);
  ObjectBank bank;
  bank.add(example);
  ASSERT_EQ(bank.objects(ObjectClass::car).size(), 1U);
  const BankedObject& object = bank.objects(ObjectClass::car)[0];
  EXPECT_EQ(object.points.size(), 40U);
  EXPECT_EQ(object.label.box.center_lidar_m, labels[0].box.center_lidar_m);
  example.boxes[0].demanded = false;
  ObjectBank none;
  none.add(example);
  none.add({});
  EXPECT_TRUE(none.objects(ObjectClass::car).empty());
}

TEST(ObjectBank, CountsThePointsThatAreLeft) {
  TrainingExample example = made_example({made_label("car", 10.0, 0.0, 0.0)});
  example.points.resize(4);  // of the car's; the label still says 40
  ObjectBank bank;
  bank.add(example);
  EXPECT_TRUE(bank.objects(ObjectClass::car).empty());
}

TEST(ObjectBank, HoldsNoMoreThanItsLimitsFromEarlyAndLate) {
  ObjectBank bank({.objects = 20, .points = 10});
  std::set<float> sources;
  for (int i = 0; i < 100; ++i) {
    TrainingExample example = made_example({made_label("car", 10.0, 0.0, 0.0)});
    for (Point& point : example.points) point.intensity = static_cast<float>(i);
    bank.add(example);
    EXPECT_LE(bank.objects(ObjectClass::car).size(), 20U);
  }
  for (const BankedObject& object : bank.objects(ObjectClass::car)) {
    EXPECT_EQ(object.points.size(), 10U);
    sources.insert(object.points.front().intensity);
  }
  EXPECT_EQ(sources.size(), 20U);  // each once
  EXPECT_GT(std::ranges::count_if(sources, [](float i) { return i >= 50.0F; }), 3);
  EXPECT_GT(std::ranges::count_if(sources, [](float i) { return i < 50.0F; }), 3);
}

TEST(PlaceObjects, FillsUpWithoutOverlap) {
  const ObjectBank bank = bank_of_streets(10);
  const SamplingConfig config{.cars = 8, .pedestrians = 9};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const TrainingExample before = made_street(seed);
    const TrainingExample after = place_objects(before, bank, config, random);
    EXPECT_EQ(std::ranges::count(after.boxes, ObjectClass::car, &TrainingBox::object_class), 8);
    EXPECT_EQ(std::ranges::count(after.boxes, ObjectClass::pedestrian, &TrainingBox::object_class), 9);
    for (std::size_t i = 0; i < after.boxes.size(); ++i) {
      EXPECT_EQ(after.boxes[i].points, count_within(after.points, after.boxes[i].box));
      EXPECT_EQ(after.boxes[i].points, 40U);  // of the object alone, not of the ground that was there
      for (std::size_t j = 0; j < i && i >= before.boxes.size(); ++j) {
        EXPECT_EQ(footprint_iou(after.boxes[i].box, after.boxes[j].box), 0.0);
      }
    }
  }
}

TEST(PlaceObjects, NothingWhereTheBankIsEmptyOrThereIsEnough) {
  const TrainingExample before = made_street(1);
  Random random(1);
  EXPECT_EQ(place_objects(before, ObjectBank(), {}, random).boxes.size(), before.boxes.size());
  const SamplingConfig enough{.cars = 4, .pedestrians = 2};
  const TrainingExample after = place_objects(before, bank_of_streets(3), enough, random);
  EXPECT_EQ(after.boxes.size(), before.boxes.size());
  EXPECT_EQ(after.points.size(), before.points.size());
}

TEST(PlaceObjects, ThoseThatAreNotDemandedDoNotCount) {
  TrainingExample before = made_street(1);
  for (TrainingBox& label : before.boxes) label.demanded = false;
  Random random(1);
  const TrainingExample after =
      place_objects(before, bank_of_streets(3), {.cars = 2, .pedestrians = 0}, random);
  EXPECT_EQ(after.boxes.size(), before.boxes.size() + 2);
}

TEST(PlaceObjects, AGreedyWishEnds) {
  Random random(1);
  const TrainingExample after = place_objects(made_street(1), bank_of_streets(5), {.cars = 200}, random);
  EXPECT_LE(std::ranges::count(after.boxes, ObjectClass::car, &TrainingBox::object_class), 24);
}

TEST(PlaceObjects, OnTheGroundThatIsThere) {
  const ObjectBank bank = bank_of_streets(5);
  TrainingExample raised = make_example("dense", made_points({}, 1, 0, 60000), {}, std::nullopt, 5);
  for (Point& point : raised.points) point.p_lidar.z() += 0.3F;
  Random random(2);
  const SamplingConfig config{.cars = 3, .pedestrians = 3, .max_lift_m = 0.5};
  const TrainingExample after = place_objects(raised, bank, config, random);
  ASSERT_EQ(after.boxes.size(), 6U);
  for (const TrainingBox& label : after.boxes) {
    EXPECT_NEAR(label.box.center_lidar_m.z() - 0.5 * label.box.size_lwh_m.z(), kGroundZ_m + 0.28, 1e-5);
    EXPECT_EQ(count_within(after.points, label.box), 40U);
  }
  for (Point& point : raised.points) point.p_lidar.z() += 1.0F;
  EXPECT_TRUE(place_objects(raised, bank, config, random).boxes.empty());
}

TEST(PlaceObjects, OnlyInTheView) {
  LabelledView view;
  view.T_camera0_lidar = T_camera0_level();
  view.P2 << 700.0, 0.0, 621.0, 0.0, 0.0, 700.0, 187.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  TrainingExample example = make_example("ahead", made_example({}).points, {}, view, 5);
  Random random(3);
  const TrainingExample after = place_objects(example, bank_of_streets(10), {.cars = 20}, random);
  EXPECT_FALSE(after.boxes.empty());
  for (const TrainingBox& label : after.boxes) EXPECT_TRUE(shows(view, label.box.center_lidar_m));
}

TEST(PlaceObjects, IntoAnEmptyExample) {
  Random random(3);
  const TrainingExample after = place_objects({}, bank_of_streets(3), {.cars = 5, .pedestrians = 0}, random);
  EXPECT_EQ(after.boxes.size(), 5U);
  EXPECT_EQ(after.points.size(), 5U * 40U);
}

}  // namespace
}  // namespace mlo
