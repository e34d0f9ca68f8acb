#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/network/box_code.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

Eigen::RowVectorXf full_code(const Box3d& box, const Eigen::Vector3d& candidate, std::size_t class_index,
                             const NetworkArchitecture& architecture) {
  const int bins = architecture.box_code.angle_bins;
  Eigen::RowVectorXf code = Eigen::RowVectorXf::Zero(architecture.box_code.size());
  code.head<6>() = encode_box(box, candidate, class_index, architecture).transpose().cast<float>();
  const AngleCode angle = encode_angle(box.yaw_rad, architecture.box_code);
  code[6 + angle.bin] = 1.0F;
  code[6 + bins + angle.bin] = static_cast<float>(angle.residual);
  return code;
}

TEST(BoxCode, DecodingUndoesEncoding) {
  NetworkArchitecture architecture = test::tiny_architecture();
  for (const bool in_sizes : {true, false}) {
    architecture.box_code.center_in_sizes = in_sizes;
    architecture.box_code.log_size = in_sizes;
    architecture.box_code.first_angle_rad = in_sizes ? 0.0 : -std::numbers::pi + std::numbers::pi / 12.0;
    for (double yaw_rad = -3.1; yaw_rad < 3.14; yaw_rad += 0.037) {
      const Box3d box{{12.0, -3.0, 0.8}, {4.6, 1.8, 1.6}, yaw_rad};
      const Eigen::Vector3d candidate(11.3, -2.2, 0.9);
      const Box3d decoded =
          decode_box(full_code(box, candidate, 0, architecture), candidate, 0, architecture);
      EXPECT_LT((decoded.center_lidar_m - box.center_lidar_m).norm(), 1e-5);
      EXPECT_LT((decoded.size_lwh_m - box.size_lwh_m).norm(), 1e-5);
      EXPECT_NEAR(std::remainder(decoded.yaw_rad - yaw_rad, 2.0 * std::numbers::pi), 0.0, 1e-6);
    }
  }
}

TEST(BoxCode, ResidualsStayWithinTheirBin) {
  const BoxCodeSpec code{.angle_bins = 12, .first_angle_rad = 0.4};
  for (double yaw_rad = -7.0; yaw_rad < 7.0; yaw_rad += 0.013) {
    const AngleCode angle = encode_angle(yaw_rad, code);
    EXPECT_LE(std::abs(angle.residual), 1.0 + 1e-12);
    EXPECT_GE(angle.bin, 0);
    EXPECT_LT(angle.bin, 12);
  }
}

TEST(BoxCode, WildSizesStayFinite) {
  const NetworkArchitecture architecture = test::tiny_architecture();
  Eigen::RowVectorXf code = Eigen::RowVectorXf::Zero(architecture.box_code.size());
  code.segment<3>(3).setConstant(1e6F);
  EXPECT_TRUE(decode_box(code, Eigen::Vector3d::Zero(), 0, architecture).size_lwh_m.allFinite());
}

TEST(BoxCode, OnlyTheSureAreDecoded) {
  const NetworkArchitecture architecture = test::tiny_architecture();
  NetworkOutput output{PointRows::Zero(3, 3), RowMatrix(3, 2),
                       RowMatrix::Zero(3, architecture.box_code.size())};
  output.class_logits << 0.1F, -3.0F, -2.0F, -4.0F, 0.0F, 2.0F;
  const std::vector<Detection> boxes = decode_boxes(output, architecture, 0.5);
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].object_class, ObjectClass::car);
  EXPECT_EQ(boxes[1].object_class, ObjectClass::pedestrian);
  EXPECT_NEAR(boxes[1].confidence, 1.0 / (1.0 + std::exp(-2.0)), 1e-6);
}

}  // namespace
}  // namespace mlo
