#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/evaluation/plot.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Plot, HoldsTitlesLabelsLegendAndOneLinePerCurve) {
  const std::vector<PlotPanel> panels{
      {"Path", "x [m]", "y [m]", true, {{"truth", 0, {{0, 0}, {10, 5}}}, {"a<b & c", 1, {{0, 0}, {10, 4}}}}},
      {"Error", "frame", "[m]", false, {{"a<b & c", 1, {{0, 0.5}, {1, 0.25}}}}}};
  const std::string svg = svg_plot(panels);
  EXPECT_THAT(svg, testing::StartsWith("<svg "));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  for (const char* text : {">Path<", ">Error<", ">x [m]<", ">[m]<", ">truth<", ">a&lt;b &amp; c<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_EQ(count_of(svg, "<path "), 3U);
}

TEST(Plot, EqualScaleMakesAUnitAsLongOnBothAxes) {
  const std::string svg =
      svg_plot(std::vector<PlotPanel>{{"", "", "", true, {{"", 0, {{0, 0}, {30, 0}, {30, 40}}}}}});
  const std::regex corner("M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, corner)) << svg;
  const auto at = [&](int i) { return std::stod(match[static_cast<std::size_t>(i)]); };
  EXPECT_NEAR((at(3) - at(1)) / 30.0, (at(4) - at(6)) / 40.0, 0.01);  // y grows upwards
  EXPECT_GT(at(3), at(1));
}

TEST(Plot, GapsWherePointsAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = svg_plot(
      std::vector<PlotPanel>{{"", "", "", false, {{"", 0, {{0, 1}, {1, 1}, {2, nan}, {3, 1}, {4, 1}}}}}});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const std::size_t begin = svg.find("<path d=");
  EXPECT_EQ(count_of(svg.substr(begin, svg.find("/>", begin) - begin), "M"), 2U);
}

TEST(Plot, NothingAndSinglePointsAndConstantsDraw) {
  EXPECT_THAT(svg_plot({}), HasSubstr("</svg>"));
  for (const bool equal_scale : {false, true}) {
    for (const std::vector<Eigen::Vector2d>& points :
         {std::vector<Eigen::Vector2d>{}, {{5, 5}}, {{0, 0}, {9, 0}}, {{2e6, 3}, {2e6, 4}}}) {
      const std::string svg = svg_plot(std::vector<PlotPanel>{{"", "", "", equal_scale, {{"", 0, points}}}});
      EXPECT_THAT(svg, Not(HasSubstr("nan")));
      EXPECT_THAT(svg, Not(HasSubstr("inf")));
      EXPECT_LT(svg.size(), 20000U);
    }
  }
}

}  // namespace
}  // namespace mlo
