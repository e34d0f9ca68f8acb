#pragma once

#include <vector>

#include "detection/made_scan.hpp"

namespace mlo::test {

/// A street of 80 m with 24 parked cars between walls: some 100 000 points.
inline MadeScan make_street() {
  std::vector<Box3d> cars;
  for (int k = 0; k < 24; ++k) {
    cars.push_back(standing(-36.0 + 3.1 * k, k % 2 == 0 ? 5.5 : -5.5, {4.1, 1.75, 1.5}, 0.05 * (k % 5)));
  }
  MadeScan scan;
  scan.add_ground(cars, 60.0);
  for (const Box3d& car : cars) scan.add_car(car);
  for (double x = -40.0; x < 40.0; x += 0.04) {
    for (double z = -1.5; z < 5.0; z += 0.3) {
      scan.add({x, 9.0, z});
      scan.add({x, -9.0, z});
    }
  }
  return scan;
}

}  // namespace mlo::test
