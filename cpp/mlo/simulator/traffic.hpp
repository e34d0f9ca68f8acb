#pragma once

#include <functional>
#include <vector>

#include "mlo/simulator/motion.hpp"
#include "mlo/simulator/path.hpp"

namespace mlo::simulator {

/// One vehicle of a lane.
struct Driver {
  double s_start_m = 0.0;  ///< of its middle, along the lane
  double length_m = 4.5;
  double start_speed_mps = 0.0;
  /// What it would drive on an empty straight road [m/s] at a time [s].
  std::function<double(double time_s)> desired_mps;
};

/// Where and when a lane is closed: a red light, or a queue that starts and stops.
struct RedLight {
  double s_m = 0.0;        ///< stop line
  double period_s = 40.0;  ///< red for red_s, then green for the rest
  double red_s = 15.0;
  double phase_s = 0.0;  ///< red begins at this time and every period before and after

  bool red_at(double time_s) const;
};

struct TrafficRules {
  double max_acceleration_mps2 = 1.6;
  double comfortable_braking_mps2 = 2.0;
  double gap_s = 1.3;  ///< kept to the vehicle ahead, in time
  double standstill_gap_m = 2.2;
  double max_lateral_mps2 = 2.2;  ///< limits the speed in bends
};

/// Motions of all vehicles of a lane, first driver foremost, by the intelligent driver model (Treiber et al.
/// 2000): they keep their distance, slow down for bends, and stop at red lights.
std::vector<Motion> drive_lane(const Path& lane, const std::vector<Driver>& front_to_back,
                               const std::vector<RedLight>& lights, const TrafficRules& rules,
                               double duration_s);

}  // namespace mlo::simulator
