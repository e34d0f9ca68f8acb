#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/learning/curves.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;

const std::vector<TrainingRow> kRows{
    {.step = 100, .loss = {1.0, 2.0, 3.0, 4.0, 5.0, 17.0}, .learning_rate = 0.001, .ap = {0.25, 0.5}},
    {.step = 200, .loss = {0.5, 1.0, 1.5, 2.0, 2.5, 18.0}, .learning_rate = 0.002, .ap = {0.5, 0.75}}};
const std::vector<ObjectClass> kClasses{ObjectClass::car, ObjectClass::pedestrian};

TEST(Curves, AreATableAndDiagrams) {
  EXPECT_EQ(curves_csv(kRows, kClasses),
            "step,learning_rate,classes,boxes,angles,corners,shifts,positives,ap_car,ap_pedestrian\n"
            "100,0.001,1,2,3,4,5,17,0.2500,0.5000\n"
            "200,0.002,0.5,1,1.5,2,2.5,18,0.5000,0.7500\n");
  EXPECT_THAT(curves_svg(kRows, kClasses), HasSubstr("pedestrian"));
  EXPECT_THAT(curves_svg({}, kClasses), HasSubstr("</svg>"));
}

TEST(Curves, SurviveTheSavedState) {
  EXPECT_EQ(curves_csv(rows_from(to_tensor(kRows)), kClasses), curves_csv(kRows, kClasses));
  EXPECT_TRUE(rows_from(to_tensor({})).empty());
}

}  // namespace
}  // namespace mlo
