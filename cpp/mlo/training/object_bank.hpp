#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "mlo/core/random.hpp"
#include "mlo/training/config.hpp"
#include "mlo/training/example.hpp"

namespace mlo {

/// An object cut out of a scan, where it was in the lidar frame.
struct BankedObject {
  TrainingBox label;
  std::vector<Point> points;
};

struct ObjectBankLimits {
  std::size_t objects = 2000;  ///< of a class; of more, each is kept with the same probability
  std::size_t points = 4096;   ///< of an object; more are thinned (core/point_budget.hpp)
  std::size_t min_points = 5;  ///< objects with fewer are of no use
};

/// Objects to put into other scans (ground-truth sampling, Yan et al., SECOND, 2018). Bounded memory; the
/// same examples in the same order give the same bank.
class ObjectBank {
 public:
  explicit ObjectBank(ObjectBankLimits limits = {}, std::uint64_t seed = 0)
      : limits_(limits), random_(seed) {}

  /// Takes the demanded objects of an example whose boxes share no ground with others'.
  void add(const TrainingExample& example);
  /// Those of a class; they stay where they are until the next add().
  std::span<const BankedObject> objects(ObjectClass object_class) const;

 private:
  struct Shelf {
    std::vector<BankedObject> objects;
    std::size_t offered = 0;
  };
  ObjectBankLimits limits_;
  Random random_;
  std::map<ObjectClass, Shelf> shelves_;
};

/// True if the footprints, the first grown by a margin on all sides, share ground.
bool collide(const Box3d& a, const Box3d& b, double margin_m = 0.0);

/// Fills an example up with objects of the bank, each at the place and range where it was, on the ground that
/// is there now. They collide with nothing, lie in the example's view, and replace the points in their boxes;
/// points hidden behind them stay.
TrainingExample place_objects(TrainingExample example, const ObjectBank& bank, const SamplingConfig& config,
                              Random& random);

}  // namespace mlo
