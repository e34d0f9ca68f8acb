#pragma once

#include "mlo/simulator/scene.hpp"

namespace mlo::simulator {

/// Flat ground, a wall across the way 20 m ahead of the robot's start, and one car that drives across at 8
/// m/s.
inline Scene small_scene() {
  Scene scene;
  scene.name = "test";
  scene.meshes = {quad({-100, -100, 0}, {100, -100, 0}, {100, 100, 0}, {-100, 100, 0}, Surface::road),
                  cuboid({20, -30, 0}, {21, 30, 8}, Surface::wall)};
  scene.statics = {{0, SE3()}, {1, SE3()}};
  scene.models = {make_car(Random(1))};
  scene.objects = {
      {1, 0, cruise(straight({10.0, -20.0}, 1.5707963267948966, 100.0), 0.0, 8.0, 5.0), 0.0, true}};
  scene.robot.planar = cruise(straight({-10.0, 0.0}, 0.0, 60.0), 0.0, 5.0, 5.0);
  scene.duration_s = 5.0;
  return scene;
}

}  // namespace mlo::simulator
