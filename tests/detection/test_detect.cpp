#include <gtest/gtest.h>

#include "detection/made_scan.hpp"
#include "mlo/core/box_overlap.hpp"
#include "mlo/core/log_odds.hpp"
#include "mlo/detection/detect.hpp"

namespace mlo {
namespace {

TEST(Detect, ByTheDetectorOfTheConfiguration) {
  const test::MadeScan scan = test::street_with(test::kParkedCars);
  DetectionConfig config;
  const FoundObjects found = detect(scan.points, scan.is_ground, std::nullopt, config);
  ASSERT_EQ(found.objects.size(), test::kParkedCars.size());
  EXPECT_GE(found.objects[0].confidence, found.objects[1].confidence);
  EXPECT_GE(found.likely.size(), found.objects.size());
  config.detector = Detector::none;
  EXPECT_TRUE(detect(scan.points, scan.is_ground, std::nullopt, config).objects.empty());
  EXPECT_TRUE(detect({}, {}, std::nullopt, {}).objects.empty());
}

TEST(Detect, ConfidencesAreOnTheScaleOfTracking) {
  const test::MadeScan scan = test::street_with(test::kParkedCars);
  const FoundObjects found = detect(scan.points, scan.is_ground, std::nullopt, {});
  EXPECT_NEAR(log_odds(found.objects[0].confidence), 2.0 + 3.0 * log_odds(found.likely[0].confidence), 1e-6);
}

TEST(Detect, WhatWasThereBeforeIsSurer) {
  const test::MadeScan scan = test::street_with(test::kParkedCars);
  const FoundObjects first = detect(scan.points, scan.is_ground, std::nullopt, {});
  const FoundBefore before{first.likely, SE3()};
  const FoundObjects again = detect(scan.points, scan.is_ground, before, {});
  ASSERT_EQ(again.objects.size(), first.objects.size());
  for (std::size_t i = 0; i < first.objects.size(); ++i) {
    EXPECT_GT(again.objects[i].confidence, first.objects[i].confidence);
  }
  const FoundObjects as_new = detect(scan.points, scan.is_ground, FoundBefore{}, {});
  EXPECT_LT(as_new.likely[0].confidence, first.likely[0].confidence);
}

}  // namespace
}  // namespace mlo
