#pragma once

#include <cstddef>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/network.hpp"

namespace mlo {

/// The bin of an angle, and where in it: -1 at its lower, 1 at its upper border.
struct AngleCode {
  int bin = 0;
  double residual = 0.0;
};
AngleCode encode_angle(double yaw_rad, const BoxCodeSpec& code);
double decode_angle(const AngleCode& angle, const BoxCodeSpec& code);

/// Offset of the centre and the size of a box of a class, seen from a candidate: the first six numbers of its
/// code.
Eigen::Matrix<double, 6, 1> encode_box(const Box3d& box, const Eigen::Vector3d& candidate,
                                       std::size_t class_index, const NetworkArchitecture& architecture);
/// The box that a code (BoxCodeSpec::size() numbers: offset, size, likelihood of each bin, residual in each)
/// tells.
Box3d decode_box(const Eigen::RowVectorXf& code, const Eigen::Vector3d& candidate, std::size_t class_index,
                 const NetworkArchitecture& architecture);

/// The boxes of all candidates whose confidence, the logistic function of the largest class logit, is at
/// least so large; in the frame of the input and the order of the candidates.
std::vector<Detection> decode_boxes(const NetworkOutput& output, const NetworkArchitecture& architecture,
                                    double min_confidence);

}  // namespace mlo
