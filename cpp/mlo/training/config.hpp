#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/fields.hpp"

namespace mlo {

/// Objects of other scans put among those of an example, object_bank.hpp.
struct SamplingConfig {
  int cars = 15;
  int vans = 3;
  int trucks = 2;
  int pedestrians = 8;
  int cyclists = 8;
  double clearance_m = 0.2;
  double max_lift_m = 0.0;

  /// Demanded objects of a class that an example is filled up to; 0 for what has no setting.
  int wanted(ObjectClass object_class) const {
    switch (object_class) {
      case ObjectClass::car:
        return cars;
      case ObjectClass::van:
        return vans;
      case ObjectClass::truck:
        return trucks;
      case ObjectClass::pedestrian:
        return pedestrians;
      case ObjectClass::cyclist:
        return cyclists;
      case ObjectClass::other:
        return 0;
    }
    return 0;
  }

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("cars", cars, between(0, 200),
          "cars that a scan is filled up to with those of other scans; 0: none");
    visit("vans", vans, between(0, 200), "the same of vans");
    visit("trucks", trucks, between(0, 200), "the same of trucks");
    visit("pedestrians", pedestrians, between(0, 200), "the same of pedestrians");
    visit("cyclists", cyclists, between(0, 200), "the same of cyclists");
    visit("clearance_m", clearance_m, between(0.0, 5.0), "free space between objects that are put there [m]");
    visit(
        "max_lift_m", max_lift_m, between(0.0, 10.0),
        "an object is raised or lowered to the ground that is there, if that is no more than this [m]; 0: it "
        "stays at its height, as it should where heights are above the ground already");
  }
};

/// Each object moved by itself.
struct ObjectNoiseConfig {
  double probability = 0.5;
  double position_m = 0.25;
  double max_turn_deg = 9.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("probability", probability, between(0.0, 1.0), "that an object is moved; 0: never");
    visit("position_m", position_m, between(0.0, 5.0), "standard deviation of its shift in x and in y [m]");
    visit("max_turn_deg", max_turn_deg, between(0.0, 180.0), "it turns by up to this to either side [deg]");
  }
};

/// What is done to an example so that no two look alike, augmentation.hpp.
struct AugmentationConfig {
  SamplingConfig sampling;
  ObjectNoiseConfig object_noise;
  double flip_probability = 0.5;
  double max_rotation_deg = 45.0;
  double max_scaling = 0.05;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("sampling", sampling, "Objects of other scans put among those of a scan.");
    visit.group("object_noise", object_noise, "Each object moved by itself.");
    visit("flip_probability", flip_probability, between(0.0, 1.0),
          "that left and right are exchanged (y becomes -y); 0: never");
    visit("max_rotation_deg", max_rotation_deg, between(0.0, 180.0),
          "the whole scan turns about z by up to this to either side [deg]; 0: not at all");
    visit("max_scaling", max_scaling, between(0.0, 0.5),
          "all lengths grow or shrink by up to this share; 0: not at all");
  }
};

}  // namespace mlo
