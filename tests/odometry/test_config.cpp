#include <gmock/gmock.h>

#include "mlo/odometry/config.hpp"

namespace mlo {
namespace {

TEST(OdometryConfig, HasNoProblemsByDefault) {
  EXPECT_THAT(OdometryConfig{}.find_problems(), testing::IsEmpty());
}

TEST(OdometryConfig, NamesWhatContradictsItself) {
  OdometryConfig config;
  config.initial_gate_m = 0.1;
  config.min_baseline_m = config.patch_radius_m;
  EXPECT_THAT(config.find_problems(),
              testing::ElementsAre(testing::HasSubstr("final_gate_m"), testing::HasSubstr("min_baseline_m")));
}

}  // namespace
}  // namespace mlo
