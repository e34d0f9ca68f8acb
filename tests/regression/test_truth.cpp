#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/evaluation/tracking_evaluation.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/truth/labelled_map.hpp"
#include "regression/drive.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using simulator::SceneKind;

class Truth : public testing::Test {
 protected:
  void SetUp() override {
    test::simulate_drive({.kind = SceneKind::city, .length_m = 60.0, .seed = 11}, 12, drive_.path());
  }
  std::filesystem::path file(const std::string& name) const { return drive_.path() / name; }

 private:
  test::TempFolder drive_;
};

/// The perfect detections of the camera's view as tracks: a detection belongs to the object whose label has
/// its place. Lines as AB3DMOT reads them: frame,type,x1,y1,x2,y2,score,h,w,l,x,y,z,ry,alpha.
std::vector<ObjectRecord> as_tracks(const std::filesystem::path& detections,
                                    const std::vector<ObjectRecord>& labels) {
  constexpr int kCar = 2;
  std::vector<ObjectRecord> tracks;
  std::ifstream stream(detections);
  for (std::string line; std::getline(stream, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    const std::vector<double> v{std::istream_iterator<double>(words), {}};
    if (v.size() != 15 || static_cast<int>(v[1]) != kCar) continue;
    for (const ObjectRecord& label : labels) {
      const KittiBox box = kitti_box_of(label);
      const Eigen::Vector3d place(v[10], v[11], v[12]);
      if (label.frame != static_cast<std::size_t>(v[0]) || (box.bottom_camera0_m - place).norm() > 0.05)
        continue;
      ObjectRecord track = label;
      track.type = "car";
      track.image_box = {v[2], v[3], v[4], v[5]};
      track.score = v[6];
      tracks.push_back(track);
    }
  }
  return tracks;
}

TEST_F(Truth, PerfectDetectionsScoreAsPerfect) {
  SequenceRecords sequence{
      .name = "0000", .truth = read_kitti_tracks(file("label_02/0000.txt")), .tracks = {}};
  sequence.tracks = as_tracks(file("detections/perfect/0000.txt"), sequence.truth);
  for (const Similarity similarity : {Similarity::image_iou, Similarity::box_iou}) {
    TrackingProtocol protocol;
    protocol.similarity = similarity;
    protocol.match_threshold = 0.9;
    const TrackingScores scores = evaluate_tracking(std::vector{sequence}, protocol).all;
    EXPECT_GT(scores.clear.true_positives, 20U);
    EXPECT_EQ(scores.clear.false_negatives, 0U);
    EXPECT_EQ(scores.clear.false_positives, 0U);
    EXPECT_EQ(scores.clear.id_switches, 0U);
    EXPECT_DOUBLE_EQ(scores.clear.mota(), 1.0);
    EXPECT_GT(scores.hota.hota(), 0.99);
  }
}

using Cell = std::tuple<long, long, long>;

Cell cell_of(const Eigen::Vector3f& p, double size_m) {
  const auto index = [&](float x) { return std::lround(std::floor(static_cast<double>(x) / size_m)); };
  return {index(p.x()), index(p.y()), index(p.z())};
}

/// Point labels and true map come from different code: what is labelled static in the scans must lie on the
/// true map, what is labelled moving must not.
TEST_F(Truth, PointLabelsAgreeWithTheStaticMap) {
  constexpr double kCell_m = 0.4;
  std::set<Cell> map;
  for (const MapPoint& point : read_map(file("truth/static_map.ply"))) {
    const auto [x, y, z] = cell_of(point.p_map, kCell_m);
    for (long dx = -1; dx <= 1; ++dx) {
      for (long dy = -1; dy <= 1; ++dy) {
        for (long dz = -1; dz <= 1; ++dz) map.insert({x + dx, y + dy, z + dz});
      }
    }
  }
  const Dataset dataset = open_dataset(file(""), {});
  const auto labels = find_point_labels(dataset);
  ASSERT_TRUE(labels);
  const PoseList poses = read_trajectory(file("truth/poses_stamp.txt"));
  const LabelledMap found = build_labelled_map(dataset, *labels, poses, 0.2);
  EXPECT_EQ(found.scans, dataset.scans->size());
  std::size_t at_rest = 0, on_map = 0, moving = 0;
  for (const LabelledPoint& point : found.points) {
    if (point.mobility == Mobility::moving) ++moving;
    if (point.mobility != Mobility::at_rest) continue;
    ++at_rest;
    on_map += map.contains(cell_of(point.p_map, kCell_m)) ? 1U : 0U;
  }
  EXPECT_GT(at_rest, 20000U);
  EXPECT_GT(moving, 20U);
  // the rest lies on parked cars, which the true map leaves out because they could drive off
  EXPECT_GT(static_cast<double>(on_map), 0.85 * static_cast<double>(at_rest));
}

}  // namespace
}  // namespace mlo
