#include <iostream>

#include <mlo/core/se3.hpp>
#include <mlo/pipeline/config.hpp>

int main() {
  const mlo::PipelineConfig config = mlo::resolve({.presets = {"vlp16"}});
  const mlo::SE3 T_world_lidar = mlo::SE3::exp(mlo::SE3::Tangent::Constant(0.1));
  std::cout << config.sensor.name << " " << (T_world_lidar * T_world_lidar.inverse()).log().isZero(1e-12)
            << "\n";
}
