#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

std::string straight_rows(int count, double step_m) {
  std::string rows;
  for (int i = 0; i < count; ++i) rows += "1 0 0 " + std::to_string(step_m * i) + " 0 1 0 0 0 0 1 0\n";
  return rows;
}

TEST(EvalTrajectory, ComparesEstimatesInOneTable) {
  const TempFolder folder;
  const std::string truth = folder.write("truth.txt", straight_rows(20, 1.0)).string();
  const std::string good = folder.write("good.txt", straight_rows(10, 1.0)).string();
  const std::string bad = folder.write("bad.txt", straight_rows(20, 1.5)).string();
  const ProgramRun run = run_program({"eval", "trajectory", "--truth", truth, "--estimate", good, bad});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out,
              HasSubstr(good + ": matched by frame, 10 pairs; without a partner: 10 of the truth, 0 of the"));
  EXPECT_THAT(run.out, AllOf(HasSubstr("ATE [m]"), HasSubstr("0.5000")));
}

TEST(EvalTrajectory, JsonAndPlot) {
  const TempFolder folder;
  const std::string truth = folder.write("truth.txt", straight_rows(20, 1.0)).string();
  const std::string estimate = folder.write("estimate.txt", straight_rows(20, 1.5)).string();
  const std::string plot = (folder.path() / "plot.svg").string();
  const ProgramRun run =
      run_program({"eval", "trajectory", "--truth", truth, "--estimate", estimate, "--json", "--plot", plot});
  ASSERT_EQ(run.exit_code, 0);
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_NEAR(json["estimates"][0]["rte_m_per_frame"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(json["estimates"][0]["frames"].size(), 20U);
  EXPECT_TRUE(json["estimates"][0]["kitti"]["translation_percent"].is_null());
  EXPECT_THAT(read_text(plot), testing::StartsWith("<svg"));
}

TEST(EvalTrajectory, CalibrationBringsCameraPosesToTheLidar) {
  const TempFolder folder;
  // The camera looks along the lidar's x: camera z. Its truth moves along z, the lidar's estimate along x.
  const std::string calib = folder.write("calib.txt", "Tr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n").string();
  std::string rows;
  for (int i = 0; i < 5; ++i) rows += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
  const std::string truth = folder.write("truth.txt", rows).string();
  const std::string estimate = folder.write("estimate.txt", straight_rows(5, 1.0)).string();
  const ProgramRun run = run_program(
      {"eval", "trajectory", "--truth", truth, "--calib", calib, "--estimate", estimate, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_NEAR(json["estimates"][0]["rte_m_per_frame"].get<double>(), 0.0, 1e-9);
}

TEST(EvalTrajectory, MistakesEndWithOneAndNameTheFile) {
  const TempFolder folder;
  const std::string truth = folder.write("truth.txt", straight_rows(3, 1.0)).string();
  const std::string broken = folder.write("broken.txt", straight_rows(3, 1.0) + "1 2 3\n").string();
  const ProgramRun run = run_program({"eval", "trajectory", "--truth", truth, "--estimate", broken});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr(broken + ":4"));
  EXPECT_EQ(
      run_program({"eval", "trajectory", "--truth", truth, "--estimate", truth, "--match", "time"}).exit_code,
      1);
  EXPECT_EQ(run_program({"eval", "trajectory", "--truth", truth}).exit_code, 2);
}

TEST(EvalTracking, ScoresFoldersAndFiles) {
  const TempFolder folder;
  const std::string car = " 1 Car 0 0 0 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0";
  const std::string label = "0" + car + "\n1" + car + "\n";
  folder.write("truth/0000.txt", label);
  folder.write("truth/0002.txt", label);
  folder.write("tracks/0000.txt", "0" + car + " 3.5\n1" + car + " 3.5\n");
  const std::string truth = (folder.path() / "truth").string();
  const std::string tracks = (folder.path() / "tracks").string();

  const ProgramRun missing = run_program({"eval", "tracking", "--truth", truth, "--estimate", tracks});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("0002.txt"), HasSubstr("--sequences")));

  const ProgramRun table =
      run_program({"eval", "tracking", "--truth", truth, "--estimate", tracks, "--sequences", "0000"});
  EXPECT_EQ(table.exit_code, 0);
  EXPECT_THAT(table.out, AllOf(HasSubstr("TrackEval"), HasSubstr("KITTI kit: MOTA 100.00"),
                               HasSubstr("AB3DMOT: sAMOTA"), HasSubstr("3D boxes, IoU 0.7")));
  const ProgramRun json = run_program({"eval", "tracking", "--truth", truth + "/0000.txt", "--estimate",
                                       tracks + "/0000.txt", "--match", "image", "--json"});
  ASSERT_EQ(json.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(json.out)[0]["all"]["hota"].get<double>(), 1.0);
}

TEST(EvalTracking, TracksWithoutImageBoxesAreRefused) {
  const TempFolder folder;
  const std::string rest = " 1.5 1.6 4.0 2.0 1.7 20.0 0.0\n";
  const std::string truth = folder.write("truth.txt", "0 1 Car 0 0 0 10 20 110 70" + rest).string();
  const std::string tracks = folder.write("tracks.txt", "0 1 Car 0 0 0 -1 -1 -1 -1" + rest).string();
  const ProgramRun run = run_program({"eval", "tracking", "--truth", truth, "--estimate", tracks});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("no image box"), HasSubstr("--calib")));
}

TEST(EvalTracking, ProjectsBoxesWhereImageBoxesAreMissing) {
  const TempFolder folder;
  // 20 m ahead, 4 m long across the view, 1.5 m high, bottom 1.5 m below the camera; focal length 500 px. The
  // near face is 19.2 m away: u = 500 +- 500 * 2 / 19.2, v from 200 to 200 + 500 * 1.5 / 19.2.
  const std::string rest = " 1.5 1.6 4.0 0.0 1.5 20.0 0.0\n";
  const std::string truth =
      folder.write("truth.txt", "0 1 Car 0 0 0 447.9167 200 552.0833 239.0625" + rest).string();
  const std::string tracks = folder
                                 .write("tracks.txt", "0 1 Car 0 0 0 -1 -1 -1 -1" + rest +
                                                          "0 2 Car 0 0 0 -1 -1 -1 -1 1.5 1.6 4 0 1.5 -20 0\n")
                                 .string();
  const std::string calib = folder.write("calib.txt", "P2: 500 0 500 0 0 500 200 0 0 0 1 0\n").string();
  const ProgramRun run = run_program({"eval", "tracking", "--truth", truth, "--estimate", tracks, "--calib",
                                      calib, "--match", "image", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto all = nlohmann::json::parse(run.out)[0]["all"];
  EXPECT_NEAR(all["motp"].get<double>(), 1.0, 1e-5);
  EXPECT_EQ(all["false_positives"].get<int>(), 0);  // the car behind the camera is not in the image
}

constexpr const char* kAsciiPcd =
    "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n";

TEST(EvalMap, MeasuresRemovalAgainstLabels) {
  const TempFolder folder;
  const std::string truth = folder.write("gt.pcd", std::string(kAsciiPcd) + "1 0 0 0\n5 0 0 1\n").string();
  const std::string clean = folder.write("clean.pcd", std::string(kAsciiPcd) + "1 0 0 0\n1 0 0 0\n").string();
  const std::string raw = folder.write("raw.pcd", std::string(kAsciiPcd) + "1 0 0 0\n5 0 0 0\n").string();
  const ProgramRun table = run_program({"eval", "map", "--cloud", clean, "--cloud", raw, "--truth", truth});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, AllOf(HasSubstr("ERASOR"), HasSubstr("100.00")));
  const ProgramRun run =
      run_program({"eval", "map", "--cloud", clean, "--cloud", raw, "--truth", truth, "--json"});
  ASSERT_EQ(run.exit_code, 0);
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json[0]["removal"]["f1"].get<double>(), 1.0);
  EXPECT_EQ(json[1]["removal"]["rejection_rate"].get<double>(), 0.0);
  EXPECT_EQ(json[1]["removal"]["static_accuracy"].get<double>(), 1.0);
}

TEST(EvalMap, AFolderWithoutLabelsIsRefused) {
  const TempFolder folder;
  folder.write("scans/000000.bin", std::string(64, '\0'));
  const std::string map = folder.write("map.pcd", std::string(kAsciiPcd) + "1 0 0 0\n5 0 0 1\n").string();
  const ProgramRun run =
      run_program({"eval", "map", "--cloud", map, "--truth", (folder.path() / "scans").string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("label"));
}

TEST(EvalObjects, MeasuresTrajectoriesAndCountsLosses) {
  const TempFolder folder;
  std::string truth = "frame,id,class,x_m,y_m,z_m,qx,qy,qz,qw\n";
  std::string tracks = truth;
  for (int frame = 0; frame < 10; ++frame) {
    const std::string start = std::to_string(frame) + ",";
    const std::string x = std::to_string(frame);
    truth += start + "1,car," + x + ",0,0,0,0,0,1\n";
    truth += start + "2,van," + x + ",9,0,0,0,0,1\n";
    tracks += start + "40,car," + x + ",0.5,0,0,0,0,1\n";
  }
  const std::string truth_file = folder.write("truth.csv", truth).string();
  const std::string track_file = folder.write("tracks.csv", tracks).string();
  const ProgramRun table = run_program({"eval", "objects", "--truth", truth_file, "--estimate", track_file});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, AllOf(HasSubstr("RTE [m/m]"), HasSubstr("2 objects: 1 lost, 0 with switches")));
  const ProgramRun run = run_program(
      {"eval", "objects", "--truth", truth_file, "--estimate", track_file, "--class", "car", "--json"});
  ASSERT_EQ(run.exit_code, 0);
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["objects"].size(), 1U);
  EXPECT_EQ(json["objects"][0]["track"].get<int>(), 40);
  EXPECT_NEAR(json["all"]["position_rmse_m"].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(json["all"]["ate_m"].get<double>(), 0.0, 1e-9);
}

TEST(EvalObjects, KittiLabelsNeedPosesAndCalibration) {
  const TempFolder folder;
  std::string labels;
  for (const char* frame : {"0", "1"}) {
    labels += std::string(frame) + " 5 Car 0 0 0 1 1 50 50 1.5 1.6 4.0 2.0 1.7 20.0 0.0\n";
  }
  const std::string truth = folder.write("0000.txt", labels).string();
  const std::string poses = folder.write("poses.txt", straight_rows(2, 3.0)).string();
  const std::string calib = folder.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n").string();
  const ProgramRun refused = run_program({"eval", "objects", "--truth", truth, "--estimate", truth});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("--truth-poses"), HasSubstr("--calib")));
  const ProgramRun run =
      run_program({"eval", "objects", "--truth", truth, "--truth-poses", poses, "--estimate", truth,
                   "--estimate-poses", poses, "--calib", calib, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["all"]["tracked_frames"].get<int>(), 2);
  EXPECT_NEAR(json["objects"][0]["path_m"].get<double>(), 3.0, 1e-6);
}

TEST(EvalDetection, ScoresObjectsSeenAllRound) {
  const TempFolder folder;
  const std::string truth =
      folder
          .write("objects.csv",
                 "frame,id,class,x_m,y_m,z_m,qx,qy,qz,qw,length_m,width_m,height_m,points\n"
                 "0,1,car,13,0,0,0,0,0,1,4,1.8,1.5,100\n"
                 "0,2,car,-20,0,0,0,0,0,1,4,1.8,1.5,100\n"
                 "1,1,car,13,0,0,0,0,0,1,4,1.8,1.5,3\n")
          .string();
  const std::string poses = folder.write("poses.txt", straight_rows(2, 3.0)).string();
  const std::string boxes = folder
                                .write("boxes.csv",
                                       "frame,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad,score\n"
                                       "0,car,13,0,0.5,4,1.8,1.5,0,0.9\n"
                                       "1,car,10,0,0,4,1.8,1.5,0,0.9\n")
                                .string();
  const std::vector<std::string> arguments{"eval", "detection", "--truth", truth, "--estimate", boxes};
  const ProgramRun refused = run_program(arguments);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--truth-poses"));
  std::vector<std::string> complete = arguments;
  complete.insert(complete.end(), {"--truth-poses", poses, "--iou", "0.6"});
  const ProgramRun table = run_program(complete);
  ASSERT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, AllOf(HasSubstr("2 frames"), HasSubstr("moderate"), HasSubstr("10-20m")));
  complete.push_back("--json");
  const auto json = nlohmann::json::parse(run_program(complete).out);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0]["box"].get<std::string>(), "BEV");
  EXPECT_EQ(json[0]["moderate"]["truth"].get<int>(), 2);  // three returns are too few to be demanded
  EXPECT_DOUBLE_EQ(json[0]["moderate"]["recall"].get<double>(), 0.5);
  EXPECT_DOUBLE_EQ(json[1]["moderate"]["recall"].get<double>(), 0.0);  // a third of the height is off
  EXPECT_EQ(json[0]["recall_by_range"][1]["found"].get<int>(), 1);
}

TEST(EvalDetection, NeedsTheCalibrationOfLabels) {
  const TempFolder folder;
  const std::string truth =
      folder.write("0000.txt", "0 5 Car 0 0 0 1 1 50 50 1.5 1.6 4.0 2.0 1.7 20.0 0.0\n").string();
  const ProgramRun refused = run_program({"eval", "detection", "--truth", truth, "--estimate", truth});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--calib"));
  const std::string calib = folder
                                .write("calib.txt",
                                       "P2: 700 0 621 0 0 700 187 0 0 0 1 0\n"
                                       "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n")
                                .string();
  const ProgramRun run =
      run_program({"eval", "detection", "--truth", truth, "--estimate", truth, "--calib", calib, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(run.out)[0]["easy"]["recall"].get<double>(), 1.0);
}

}  // namespace
}  // namespace mlo
