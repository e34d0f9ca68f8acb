#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/detections.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kNoStamp = std::numeric_limits<double>::quiet_NaN();

/// Camera at the lidar's place: x right, y down, z ahead.
Calibration plain_calibration() {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Calibration calibration;
  calibration.T_camera0_lidar = SE3::from_matrix(T);
  return calibration;
}

DetectionList read_text(const std::string& text, const std::string& name = "detections.txt",
                        const DetectionOptions& options = {}) {
  const TempFolder folder;
  return read_detections({folder.write(name, text)}, plain_calibration(), options);
}

/// The car of all the formats below: h 1.5, w 1.6, l 4, 20 m ahead, 3 m to the left, heading ahead.
void expect_the_car(const DetectionRecord& record) {
  EXPECT_EQ(record.detection.object_class, ObjectClass::car);
  EXPECT_TRUE(record.detection.box.center_lidar_m.isApprox(Eigen::Vector3d(20.0, 3.0, -0.95), 1e-9));
  EXPECT_EQ(record.detection.box.size_lwh_m, Eigen::Vector3d(4.0, 1.6, 1.5));
  EXPECT_NEAR(record.detection.box.yaw_rad, 0.0, 1e-4);
}

void expect_image(const DetectionRecord& record) {
  ASSERT_TRUE(record.image_box_px.has_value());
  EXPECT_EQ(record.image_box_px->left_px, 100.0);
  EXPECT_EQ(record.image_box_px->top_px, 110.0);
  EXPECT_EQ(record.image_box_px->right_px, 200.0);
  EXPECT_EQ(record.image_box_px->bottom_px, 210.0);
  EXPECT_DOUBLE_EQ(record.alpha_rad.value(), -1.4);
}

const std::string kBox = "-1.4 100 110 200 210 1.5 1.6 4 -3 1.7 20 -1.5708";

TEST(Detections, Ab3dmot) {
  const DetectionList list = read_text(
      "3,2,100,110,200,210,2.5,1.5,1.6,4,-3,1.7,20,-1.5708,-1.4\n3,1,1,2,3,4,-0.5,1.8,0.6,0.7,5,1.7,9,0,0\r\n"
      "7, 3, 1, 2, 3, 4, 0, 1.8, 0.6, 1.7, 5, 1.7, 9, 0, 0\n");
  EXPECT_EQ(list.count(), 3U);
  ASSERT_EQ(list.at(3, kNoStamp).size(), 2U);
  const DetectionRecord& car = list.at(3, kNoStamp)[0];
  expect_the_car(car);
  expect_image(car);
  EXPECT_EQ(car.raw_score, 2.5);
  EXPECT_DOUBLE_EQ(car.detection.confidence, 1.0 / (1.0 + std::exp(-2.5)));
  EXPECT_EQ(list.at(3, kNoStamp)[1].detection.object_class, ObjectClass::pedestrian);
  EXPECT_EQ(list.at(7, kNoStamp)[0].detection.object_class, ObjectClass::cyclist);
  EXPECT_DOUBLE_EQ(list.at(7, kNoStamp)[0].detection.confidence, 0.5);
  EXPECT_TRUE(list.at(4, kNoStamp).empty());
}

TEST(Detections, KittiTrackingLabelsAndResults) {
  const DetectionList labels =
      read_text("0 -1 DontCare -1 -1 -10 219 188 245 218 -1000 -1000 -1000 -10 -1 -1 -1\n5 12 Car 0 2 " +
                kBox + "\n5 13 Person_sitting 0 0 0 1 2 3 4 1.2 0.6 0.7 3 1.7 9 0\n");
  EXPECT_EQ(labels.count(), 2U);
  expect_the_car(labels.at(5, kNoStamp)[0]);
  expect_image(labels.at(5, kNoStamp)[0]);
  EXPECT_EQ(labels.at(5, kNoStamp)[0].detection.confidence, 1.0);
  EXPECT_EQ(labels.at(5, kNoStamp)[1].detection.object_class, ObjectClass::pedestrian);
  const DetectionList results = read_text("5 12 Car 0 2 " + kBox + " 0.75\n");
  expect_the_car(results.at(5, kNoStamp)[0]);
  EXPECT_EQ(results.at(5, kNoStamp)[0].detection.confidence, 0.75);
}

TEST(Detections, PointGnn) {
  const DetectionList list = read_text("5 Car -1 -1 " + kBox + " 37.5\n");
  expect_the_car(list.at(5, kNoStamp)[0]);
  expect_image(list.at(5, kNoStamp)[0]);
  EXPECT_EQ(list.at(5, kNoStamp)[0].raw_score, 37.5);
}

TEST(Detections, KittiObjectFilesAreFramesOfTheirFolder) {
  const TempFolder folder;
  folder.write("label/000000.txt", "");
  folder.write("label/000002.txt",
               "Car 0 2 " + kBox + "\nDontCare -1 -1 -10 1 2 3 4 -1 -1 -1 -1000 -1000 -1000 -10\n");
  folder.write("label/000010.txt", "Car 0 2 " + kBox + "\nVan 0 2 " + kBox + "\n");
  folder.write("label/notes.md", "no detections");
  const DetectionList list =
      read_detections({folder.path() / "label"}, plain_calibration(), {.sequence = "0002"});
  EXPECT_EQ(list.count(), 3U);
  expect_the_car(list.at(2, kNoStamp)[0]);
  EXPECT_EQ(list.at(10, kNoStamp)[1].detection.object_class, ObjectClass::van);
  EXPECT_TRUE(list.at(0, kNoStamp).empty());
}

TEST(Detections, LogitsAreRecognisedOverAllFilesOfAFolder) {
  const TempFolder folder;
  folder.write("result/000000.txt", "Car 0 2 " + kBox + " 0.5\n");
  folder.write("result/000001.txt", "Car 0 2 " + kBox + " -0.5\n");
  const DetectionList list = read_detections({folder.path() / "result"}, plain_calibration());
  EXPECT_DOUBLE_EQ(list.at(0, kNoStamp)[0].detection.confidence, 1.0 / (1.0 + std::exp(-0.5)));
}

TEST(Detections, TheKindOfScoresCanBeForced) {
  const std::string row = "5 12 Car 0 2 " + kBox + " 0.75\n";
  const DetectionList logits = read_text(row, "a.txt", {.scores = ScoreKind::logit});
  EXPECT_DOUBLE_EQ(logits.at(5, kNoStamp)[0].detection.confidence, 1.0 / (1.0 + std::exp(-0.75)));
  EXPECT_THAT(
      [&] { read_text("5 12 Car 0 2 " + kBox + " 1.5\n", "a.txt", {.scores = ScoreKind::confidence}); },
      ThrowsMessage<InputError>(HasSubstr("outside [0, 1]")));
}

TEST(Detections, OwnCsv) {
  const std::string columns = "class,score,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad";
  const DetectionList frames =
      read_text("Frame," + columns + ",note\r\n\r\n5,car,0.25,20,3,-0.95,4,1.6,1.5,0,seen\r\n", "a.csv");
  expect_the_car(frames.at(5, kNoStamp)[0]);
  EXPECT_EQ(frames.at(5, kNoStamp)[0].detection.confidence, 0.25);
  EXPECT_FALSE(frames.at(5, kNoStamp)[0].image_box_px.has_value());
  const DetectionList stamps = read_text("stamp_s," + columns + "\n12.5,car,1,20,3,-0.95,4,1.6,1.5,0\n");
  expect_the_car(stamps.at(99, 12.53)[0]);
  EXPECT_TRUE(read_text("frame,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad\n").by_frame.empty());
}

TEST(Detections, OwnCsvAsWritten) {
  const TempFolder folder;
  const std::vector<Detection> written{
      {ObjectClass::van, {{10.0, -4.5, -0.75}, {5.25, 2.0, 2.25}, -1.5}, 0.75},
      {ObjectClass::cyclist, {{3.0, 2.0, -1.0}, {1.75, 0.5, 1.75}, 0.5}, 0.5}};
  const auto file = folder.write("boxes.csv", detection_csv_header() + detection_csv_lines(7, written));
  const std::vector<Detection> read = read_detections({file}, {}).detections_at(7, 0.0);
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].object_class, written[i].object_class);
    EXPECT_EQ(read[i].box.center_lidar_m, written[i].box.center_lidar_m);
    EXPECT_EQ(read[i].box.size_lwh_m, written[i].box.size_lwh_m);
    EXPECT_EQ(read[i].box.yaw_rad, written[i].box.yaw_rad);
    EXPECT_EQ(read[i].confidence, written[i].confidence);
  }
}

TEST(Detections, OwnJson) {
  const std::string car =
      R"("class": "car", "center_m": [20, 3, -0.95], "size_lwh_m": [4, 1.6, 1.5], "yaw_rad": 0})";
  const DetectionList frames =
      read_text(R"({"detections": [{"frame": 5, "score": 0.25, )" + car + R"(, {"frame": 5, )" + car + "]}");
  ASSERT_EQ(frames.at(5, kNoStamp).size(), 2U);
  expect_the_car(frames.at(5, kNoStamp)[0]);
  EXPECT_EQ(frames.at(5, kNoStamp)[0].detection.confidence, 0.25);
  EXPECT_EQ(frames.at(5, kNoStamp)[1].detection.confidence, 1.0);
  const DetectionList stamps = read_text(R"({"detections": [{"stamp_s": 12.5, )" + car + "]}", "a.json");
  expect_the_car(stamps.at(0, 12.5)[0]);
  EXPECT_EQ(read_text(R"({"detections": []})").count(), 0U);
}

TEST(Detections, StampsGoToTheNearestScan) {
  const std::string row = ",car,20,3,-0.95,4,1.6,1.5,0\n";
  std::string text =
      "stamp_s,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad\n10.00" + row + "10.10" + row;
  text += "10.10" + row;
  const DetectionList list = read_text(text);
  EXPECT_EQ(list.at(0, 10.04).size(), 1U);
  EXPECT_EQ(list.at(0, 10.06).size(), 2U);
  EXPECT_EQ(list.at(0, 9.96).size(), 1U);
  EXPECT_EQ(list.at(0, 10.14).size(), 2U);
  EXPECT_TRUE(list.at(0, 9.9).empty());
  EXPECT_TRUE(list.at(0, 10.2).empty());
  EXPECT_TRUE(list.at(0, kNoStamp).empty());
}

TEST(Detections, PicksTheFileOfTheSequenceAndMergesClasses) {
  const TempFolder folder;
  const std::string tail = ",100,110,200,210,2.5,1.5,1.6,4,-3,1.7,20,-1.5708,-1.4\n";
  folder.write("d/rcnn_car/0000.txt", "3,2" + tail);
  folder.write("d/rcnn_car/0001.txt", "4,2" + tail);
  folder.write("d/rcnn_ped/0000.txt", "3,1" + tail);
  folder.write("d/rcnn_ped/0001.txt", "4,1" + tail);
  folder.write("d/rcnn_ped/0002.txt", "");
  const std::filesystem::path d = folder.path() / "d";
  const Calibration calibration = plain_calibration();
  const DetectionList merged = read_detections({d}, calibration, {.sequence = "0001"});
  ASSERT_EQ(merged.at(4, kNoStamp).size(), 2U);
  EXPECT_EQ(merged.at(4, kNoStamp)[1].detection.object_class, ObjectClass::pedestrian);
  EXPECT_TRUE(merged.at(3, kNoStamp).empty());
  EXPECT_EQ(read_detections({d / "rcnn_ped", d / "rcnn_car"}, calibration, {.sequence = "1"}).count(), 2U);
  EXPECT_EQ(read_detections({d / "rcnn_ped"}, calibration, {.sequence = "0002"}).count(), 0U);
  EXPECT_THAT([&] { read_detections({d / "rcnn_car"}, calibration); },
              ThrowsMessage<InputError>(HasSubstr("choose one of: 0000 0001")));
  EXPECT_THAT([&] { read_detections({d / "rcnn_car"}, calibration, {.sequence = "7"}); },
              ThrowsMessage<InputError>(HasSubstr("sequence '7'")));
  EXPECT_THAT(
      [&] {
        read_detections({d / "rcnn_car", d / "rcnn_car"}, calibration, {.sequence = "1"});
      },
      ThrowsMessage<InputError>(HasSubstr("class car, most likely of two detectors")));
}

TEST(Detections, NothingIsNoError) {
  EXPECT_EQ(read_text("").count(), 0U);
  EXPECT_EQ(read_text("\n \n").count(), 0U);
  EXPECT_EQ(read_detections({}, Calibration{}).count(), 0U);
}

void expect_problem(const std::string& text, const std::string& problem) {
  EXPECT_THAT([&] { read_text(text); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("detections.txt"), HasSubstr(problem))))
      << text;
}

TEST(Detections, SaysWhatIsWrongAndWhere) {
  const std::string good = "5 12 Car 0 2 " + kBox + "\n";
  expect_problem("some text\n", ":1: the format of these detections is not known");
  expect_problem(good + "5 12 Car 0 2 1 2 3\n", ":2: has 8 values, a KITTI tracking label row has 17");
  expect_problem(good + "\n5 12 Bus 0 2 " + kBox + "\n", ":3: class 'Bus' is not known");
  expect_problem("x 12 Car 0 2 " + kBox + "\n", ":1: 'x' is no frame");
  expect_problem("5 12 Car 0 2 -1.4 1 2 3 4 1.5 1.6 4 -3 nan 20 0\n", ":1: location 'nan' is not a number");
  expect_problem("5 12 Car 0 2 -1.4 1 2 3 4 -1 -1 -1 -1000 -1000 -1000 -10\n", "3D boxes with positive");
  expect_problem("3,4,1,2,3,4,2.5,1.5,1.6,4,-3,1.7,20,0,0\n", ":1: type 4 is not known");
  expect_problem("Car 0 2 " + kBox + "\n", "name the file by its frame");
  expect_problem("frame,class,x_m\n", ":1: there is no column y_m");
  const std::string columns = "class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad\n";
  expect_problem("time," + columns, "either a column frame or a column stamp_s");
  expect_problem("frame,stamp_s," + columns, "either a column frame or a column stamp_s");
  expect_problem("frame," + columns + "1,car,1,2,3\n", ":2: has 5 values for 9 columns");
  expect_problem("frame," + columns + "1,car,1,2,3,4,0,2,0\n", ":2: the box has sides of 4 x 0 x 2 m");
  expect_problem("frame," + columns + "1.5,car,1,2,3,4,2,2,0\n", ":2: '1.5' is no frame");
  expect_problem("{\"detections\": [\n{\"frame\": 1,\n]}", "line 3");
  expect_problem("[]", "no list 'detections'");
  expect_problem("{\"detections\": [3]}", "detections[0]: needs either frame or stamp_s");
  expect_problem("{\"detections\": [{\"frame\": -1}]}", "frame needs a whole number");
  expect_problem("{\"detections\": [{\"frame\": 1, \"class\": \"car\", \"center_m\": [1, 2]}]}",
                 "center_m needs three numbers");
  expect_problem("{\"detections\": [{\"frame\": 1, \"class\": 2}]}", "class needs a text");
  expect_problem("{\"detections\": [{\"frame\": 1, \"class\": \"car\"}]}", "there is no center_m");
}

TEST(Detections, SaysWhatIsMissing) {
  const TempFolder folder;
  EXPECT_THAT([&] { read_detections({folder.path() / "none"}, Calibration{}); },
              ThrowsMessage<InputError>(HasSubstr("check the path")));
  EXPECT_THAT([&] { read_detections({folder.path()}, Calibration{}); },
              ThrowsMessage<InputError>(HasSubstr("holds no detections")));
  const auto file = folder.write("a.txt", "5 12 Car 0 2 " + kBox + "\n");
  EXPECT_THAT([&] { read_detections({file}, Calibration{}); },
              ThrowsMessage<InputError>(HasSubstr("has no calibration")));
  const auto stamped = folder.write(
      "b.csv", "stamp_s,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad\n1,van,20,3,-0.95,4,1.6,1.5,0\n");
  EXPECT_THAT(
      [&] {
        read_detections({file, stamped}, plain_calibration());
      },
      ThrowsMessage<InputError>(HasSubstr("use one of the two")));
}

}  // namespace
}  // namespace mlo
