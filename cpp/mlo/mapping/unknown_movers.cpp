#include "mlo/mapping/unknown_movers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tsl/robin_map.h>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr std::size_t kMaxJudged = 8;   // points of a column
constexpr std::size_t kMaxPlaces = 11;  // of a track, for its velocity: a second at 10 Hz
constexpr int kGap = 2;                 // columns this far apart still belong together
constexpr double kMinSure = 0.1;        // share of a thing's judged points that did not only replace the sky
constexpr double kMaxSway = 0.1;        // off a straight way, as a share of it
constexpr double kReachM = 1.0;         // around where a thing is expected
constexpr double kRearM = 10.0;         // of a thing, shows where the rest of it is

struct LineOverTime {
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  double way_m = 0.0;  // from the first place to the last
  double rms_m = 0.0;  // of the places off the line
};

template <class Places>
LineOverTime fit_line(const Places& places) {
  const auto n = static_cast<double>(places.size());
  double mean_t = 0.0;
  Eigen::Vector2d mean_p = Eigen::Vector2d::Zero();
  for (const auto& place : places) {
    mean_t += place.stamp_s / n;
    mean_p += place.center_map.template head<2>() / n;
  }
  double tt = 0.0;
  Eigen::Vector2d tp = Eigen::Vector2d::Zero();
  double pp = 0.0;
  for (const auto& place : places) {
    const double t = place.stamp_s - mean_t;
    const Eigen::Vector2d p = place.center_map.template head<2>() - mean_p;
    tt += t * t;
    tp += t * p;
    pp += p.squaredNorm();
  }
  LineOverTime line;
  if (tt <= 0.0) return line;
  line.velocity_mps = tp / tt;
  line.way_m = line.velocity_mps.norm() * (places.back().stamp_s - places.front().stamp_s);
  line.rms_m = std::sqrt(std::max(0.0, pp - tp.squaredNorm() / tt) / n);
  return line;
}

using Points2d = std::vector<Eigen::Vector2d>;

// What is long may bend: its rear shows where it came from.
Eigen::AlignedBox2d way_along_x(const Points2d& columns, double behind_m) {
  Eigen::AlignedBox2d all;
  for (const Eigen::Vector2d& column : columns) all.extend(column);
  Eigen::AlignedBox2d way;
  for (const Eigen::Vector2d& column : columns) {
    if (column.x() < all.min().x() + kRearM) way.extend(column);
  }
  way.min().x() -= behind_m;
  way.max().x() = all.max().x();
  return way;
}

}  // namespace

void UnknownMovers::remember(ScanView view) {
  views_.push_back(std::move(view));
  while (views_.size() > static_cast<std::size_t>(config_.scans_remembered)) views_.pop_front();
}

FoundMovers UnknownMovers::update(double stamp_s, std::span<const Eigen::Vector3f> points_map) {
  FoundMovers found{.movers = {}, .columns = ColumnSet(config_.column_m)};
  if (views_.size() < static_cast<std::size_t>(config_.min_free)) return found;
  std::vector<Column> columns = columns_of(points_map);
  parallel_for_each_index(
      columns.size(), [&](std::size_t i) { judge(columns[i]); }, 32);
  std::vector<Track> before = std::exchange(tracks_, {});
  for (Thing& thing : things_among(columns)) {
    for (const VoxelKey& key : thing.columns) found.columns.insert(key);
    const Track& track = tracks_.emplace_back(follow(stamp_s, std::move(thing), before));
    if (static_cast<int>(track.places.size()) < config_.min_scans || !moves_steadily(track)) continue;
    found.movers.push_back(mover_of(track));
  }
  return found;
}

UnknownMover UnknownMovers::mover_of(const Track& track) const {
  const Thing& thing = track.thing;
  UnknownMover mover;
  mover.id = track.id;
  mover.center_map = thing.center_map;
  mover.size_m = thing.extent_map.sizes();
  mover.velocity_map_mps = track.velocity_map_mps;
  mover.num_points = thing.num_points;

  const double yaw_rad = std::atan2(track.velocity_map_mps.y(), track.velocity_map_mps.x());
  const Eigen::Rotation2Dd R_way_map(-yaw_rad);
  Points2d columns_way;  // x along the motion, y to its left
  for (const VoxelKey& key : thing.columns) {
    columns_way.push_back(R_way_map * (config_.column_m * Eigen::Vector2d(key.x + 0.5, key.y + 0.5)));
  }
  const Eigen::AlignedBox2d way =
      way_along_x(columns_way, config_.came_for_s * track.velocity_map_mps.norm());
  Eigen::Vector3d middle_map = thing.extent_map.center();
  middle_map.head<2>() = R_way_map.inverse() * way.center();
  mover.T_map_way = {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), middle_map};
  mover.way_lwh_m.head<2>() = way.sizes().array() + config_.column_m;
  mover.way_lwh_m.z() = mover.size_m.z();
  return mover;
}

// Things that come apart or into view jump about instead.
bool UnknownMovers::moves_steadily(const Track& track) const {
  const LineOverTime line = fit_line(track.places);
  return line.way_m >= config_.min_way_m && line.rms_m <= kMaxSway * line.way_m;
}

std::vector<UnknownMovers::Column> UnknownMovers::columns_of(
    std::span<const Eigen::Vector3f> points_map) const {
  const ColumnSet grid(config_.column_m);
  std::vector<Column> columns;
  tsl::robin_map<VoxelKey, std::size_t, VoxelKeyHash> index;
  for (const Eigen::Vector3f& p : points_map) {
    const VoxelKey key = grid.key_of(p);
    const auto [found, is_first] = index.try_emplace(key, columns.size());
    if (is_first) columns.push_back({.key = key, .points_map = {}});
    columns[found->second].points_map.push_back(p);
  }
  return columns;
}

// Something that stood there when it was first looked at has always stood there, whatever rays went past it
// later.
UnknownMovers::Age UnknownMovers::age(const Eigen::Vector3f& p_map) const {
  int free = 0;
  int through = 0;
  for (const ScanView& view : views_) {
    const Sight sight = view.look(p_map, false, free_space_);
    if (sight == Sight::hit) return Age::old;
    if (sight == Sight::unknown) continue;
    through += sight == Sight::through ? 1 : 0;
    if (++free >= config_.min_free) return through == free ? Age::young : Age::young_before_sky;
  }
  return Age::unknown;
}

void UnknownMovers::judge(Column& column) const {
  const std::size_t count = std::min(kMaxJudged, column.points_map.size());
  int old = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Age age = this->age(column.points_map[i * column.points_map.size() / count]);
    old += age == Age::old ? 1 : 0;
    column.num_young += age == Age::young ? 1 : 0;
    column.num_before_sky += age == Age::young_before_sky ? 1 : 0;
  }
  const int young = column.num_young + column.num_before_sky;
  column.is_new = young > 0 && young >= config_.min_share * (young + old);
}

std::vector<UnknownMovers::Thing> UnknownMovers::things_among(const std::vector<Column>& columns) const {
  tsl::robin_map<VoxelKey, std::size_t, VoxelKeyHash> open;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].is_new) open.emplace(columns[i].key, i);
  }
  std::vector<Thing> things;
  for (const Column& seed : columns) {
    if (open.erase(seed.key) == 0) continue;
    Thing thing;
    std::vector<const Column*> members{&seed};
    for (std::size_t m = 0; m < members.size(); ++m) {
      const VoxelKey key = members[m]->key;
      for (int dx = -kGap; dx <= kGap; ++dx) {
        for (int dy = -kGap; dy <= kGap; ++dy) {
          const auto next = open.find({key.x + dx, key.y + dy, 0});
          if (next == open.end()) continue;
          members.push_back(&columns[next->second]);
          open.erase(next);
        }
      }
    }
    int young = 0;
    int before_sky = 0;
    for (const Column* member : members) {
      thing.columns.push_back(member->key);
      thing.num_points += member->points_map.size();
      young += member->num_young;
      before_sky += member->num_before_sky;
      for (const Eigen::Vector3f& p : member->points_map) {
        thing.extent_map.extend(p.cast<double>());
        thing.center_map += p.cast<double>();
      }
    }
    thing.center_map /= static_cast<double>(thing.num_points);
    const bool is_sure = young >= kMinSure * (young + before_sky);
    if (is_sure && thing.num_points >= static_cast<std::size_t>(config_.min_points))
      things.push_back(std::move(thing));
  }
  return things;
}

// Continues the track that is expected nearest to a thing; each is continued once.
UnknownMovers::Track UnknownMovers::follow(double stamp_s, Thing thing, std::vector<Track>& before) {
  auto best = before.end();
  double best_m = kReachM;
  for (auto it = before.begin(); it != before.end(); ++it) {
    const double dt_s = stamp_s - it->places.back().stamp_s;
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    shift.head<2>() = dt_s * it->velocity_map_mps;
    const double distance_m = it->thing.extent_map.translated(shift).exteriorDistance(thing.extent_map);
    if (distance_m < best_m) {
      best = it;
      best_m = distance_m;
    }
  }
  Track track;
  if (best == before.end()) {
    track.id = next_id_++;
  } else {
    track = std::move(*best);
    before.erase(best);
  }
  track.places.push_back({stamp_s, thing.center_map});
  if (track.places.size() > kMaxPlaces) track.places.pop_front();
  track.velocity_map_mps = fit_line(track.places).velocity_mps;
  track.thing = std::move(thing);
  return track;
}

}  // namespace mlo
