#include "mlo/simulator/surfaces.hpp"

namespace mlo::simulator {

SurfaceOptics optics(Surface surface) {
  switch (surface) {
    case Surface::road:
      return {0.26, 0.0};
    case Surface::sidewalk:
      return {0.32, 0.0};
    case Surface::grass:
      return {0.33, 0.005};
    case Surface::wall:
      return {0.35, 0.005};
    case Surface::window:
      return {0.25, 0.45};
    case Surface::roof:
      return {0.30, 0.01};
    case Surface::leaf:
      return {0.33, 0.02};
    case Surface::bark:
      return {0.30, 0.01};
    case Surface::pole:
      return {0.45, 0.02};
    case Surface::sign:
      return {0.95, 0.0};
    case Surface::barrier:
      return {0.45, 0.01};
    case Surface::rail:
      return {0.30, 0.05};
    case Surface::paint:
      return {0.40, 0.06};
    case Surface::glass:
      return {0.15, 0.70};
    case Surface::rubber:
      return {0.08, 0.02};
    case Surface::cloth:
      return {0.30, 0.0};
    case Surface::skin:
      return {0.45, 0.0};
  }
  return {};
}

std::uint16_t semantic_label(Surface surface) {
  switch (surface) {
    case Surface::road:
      return 40;
    case Surface::sidewalk:
      return 48;
    case Surface::grass:
      return 72;
    case Surface::wall:
    case Surface::window:
    case Surface::roof:
      return 50;
    case Surface::leaf:
      return 70;
    case Surface::bark:
      return 71;
    case Surface::pole:
      return 80;
    case Surface::sign:
      return 81;
    case Surface::barrier:
      return 51;
    default:
      return 52;  // other structure
  }
}

std::uint16_t semantic_label(ObjectClass object_class, bool moving) {
  switch (object_class) {
    case ObjectClass::car:
      return moving ? 252 : 10;
    case ObjectClass::truck:
      return moving ? 258 : 18;
    case ObjectClass::pedestrian:
      return moving ? 254 : 30;
    case ObjectClass::cyclist:
      return moving ? 253 : 31;
    case ObjectClass::van:
    case ObjectClass::other:
      return moving ? 259 : 20;
  }
  return 0;
}

}  // namespace mlo::simulator
