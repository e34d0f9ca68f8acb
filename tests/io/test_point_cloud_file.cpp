#include <algorithm>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::count_files;
using test::read_bytes;
using test::TempFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using namespace std::string_literals;

constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

std::filesystem::path fixtures() {
  const char* const source = std::getenv("MLO_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "tests" / "data" / "point_clouds";
}

const Eigen::Vector3f kPositions[] = {{10.5F, -2.25F, 0.5F},
                                      {11.0F, -2.5F, 0.625F},
                                      {-12.75F, 3.0F, -1.5F},
                                      {-13.0F, 3.125F, -1.625F},
                                      {14.5F, 0.0F, -1.75F}};
constexpr float kIntensities[] = {0.25F, 0.5F, 0.75F, 1.0F, 0.125F};
constexpr double kTimes_s[] = {0.0, 0.02, 0.06, 0.08, 0.1};
constexpr std::uint16_t kRings[] = {63, 62, 2, 1, 0};

/// A file and which of the fields above it has.
struct Fixture {
  std::string name;
  bool intensity = false;
  bool time = false;
  bool ring = false;
  std::size_t invalid = 0;
};

void PrintTo(const Fixture& fixture, std::ostream* out) {
  *out << fixture.name;
}

class ForeignFile : public ::testing::TestWithParam<Fixture> {};

TEST_P(ForeignFile, GivesWhatWasWritten) {
  const Fixture& expected = GetParam();
  const PointCloudFile cloud = read_point_cloud(fixtures() / expected.name);
  EXPECT_EQ(cloud.has_intensity, expected.intensity);
  EXPECT_EQ(cloud.has_time, expected.time);
  EXPECT_EQ(cloud.has_ring, expected.ring);
  EXPECT_EQ(cloud.invalid_points, expected.invalid);
  EXPECT_EQ(cloud.times_s.size(), expected.time ? 5U : 0U);
  ASSERT_EQ(cloud.points.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(cloud.points[i].p_lidar, kPositions[i]);
    EXPECT_EQ(cloud.points[i].intensity, expected.intensity ? kIntensities[i] : 0.0F);
    EXPECT_EQ(cloud.points[i].ring, expected.ring ? kRings[i] : Point::kNoRing);
    EXPECT_NEAR(expected.time ? cloud.times_s[i] : kTimes_s[i], kTimes_s[i], 1e-8);
  }
}

TEST_P(ForeignFile, IsRefusedWhenCutOff) {
  const TempFolder folder;
  const std::filesystem::path path = folder.path() / GetParam().name;
  const std::string bytes = read_bytes(fixtures() / GetParam().name);
  ASSERT_FALSE(bytes.empty());
  std::size_t complete_from = bytes.size();
  for (std::size_t size = 0; size < bytes.size(); size += bytes.size() / 61 + 1) {
    folder.write(GetParam().name, bytes.substr(0, size));
    try {
      // What does not throw must have all points: only padding, faces or the last digits may be missing.
      EXPECT_EQ(read_point_cloud(path).points.size(), 5U) << size;
      complete_from = std::min(complete_from, size);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
      EXPECT_LT(size, complete_from) << "complete with fewer bytes";
    }
  }
}

TEST_P(ForeignFile, NeverCrashesWhenDamaged) {
  const TempFolder folder;
  const std::filesystem::path path = folder.path() / GetParam().name;
  const std::string bytes = read_bytes(fixtures() / GetParam().name);
  std::mt19937 rng(11);
  for (int i = 0; i < 50; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k)
      damaged[rng() % std::min<std::size_t>(bytes.size(), 900)] = static_cast<char>(rng());
    folder.write(GetParam().name, damaged);
    try {
      const PointCloudFile cloud = read_point_cloud(path);
      for (const Point& point : cloud.points) EXPECT_TRUE(point.p_lidar.allFinite());
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, ForeignFile,
    ::testing::Values(Fixture{"pcl_ascii.pcd", true, true, true, 1},
                      Fixture{"pcl_binary.pcd", true, true, true, 1},
                      Fixture{"pcl_compressed.pcd", true, true, true, 1},
                      Fixture{"pcl_ascii.ply", true, true, true, 1},
                      Fixture{"pcl_binary.ply", true, true, true, 1}, Fixture{"open3d_ascii.pcd"},
                      Fixture{"open3d_binary.pcd"}, Fixture{"open3d_compressed.pcd"},
                      Fixture{"open3d_tensor.pcd", true, true}, Fixture{"open3d_ascii.ply"},
                      Fixture{"open3d_binary.ply"}, Fixture{"cloudcompare_ascii.ply", true, true, true},
                      Fixture{"cloudcompare_binary.ply", true, true, true}, Fixture{"vtk_ascii.ply"},
                      Fixture{"vtk_big_endian.ply"}, Fixture{"blender_ascii.ply"}),
    [](const auto& fixture) {
      std::string name = fixture.param.name;
      std::replace(name.begin(), name.end(), '.', '_');
      return name;
    });

/// Writes the text and reads it as a cloud.
PointCloudFile read_cloud_text(const std::string& name, const std::string& text) {
  const TempFolder folder;
  folder.write(name, text);
  return read_point_cloud(folder.path() / name);
}

std::string ply_of_times(const std::string& type, const std::string& lines) {
  const auto count = std::count(lines.begin(), lines.end(), '\n');
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty " + type +
         " timestamp\nend_header\n" + lines;
}

TEST(PointCloudFile, ReadsWindowsLineEndsOddTypesAndSkipsWideFields) {
  const PointCloudFile cloud =
      read_cloud_text("a.pcd",
                      "# comment\r\nVERSION .7\r\nFIELDS histogram z y x channel reflectivity\r\n"
                      "SIZE 4 2 8 4 1 2\r\nTYPE F I F I U U\r\nCOUNT 3 1 1 1 1 1\r\nWIDTH 2\r\n"
                      "HEIGHT 1\r\nDATA ascii\r\n9 9 9 -3 2.5 1 7 40000\r\n\r\n"
                      "9 9 9 -6 +5.5 4 255 1\r\n");
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0].p_lidar, Eigen::Vector3f(1.0F, 2.5F, -3.0F));
  EXPECT_EQ(cloud.points[1].p_lidar, Eigen::Vector3f(4.0F, 5.5F, -6.0F));
  EXPECT_EQ(cloud.points[0].ring, 7);
  EXPECT_EQ(cloud.points[0].intensity, 40000.0F);
}

TEST(PointCloudFile, SkipsElementsAndListsBeforeTheBinaryPoints) {
  const std::string header =
      "ply\nformat binary_big_endian 1.0\nelement face 2\nproperty list uchar short corners\nproperty uchar "
      "flag\n"
      "element empty 7\nelement vertex 1\nproperty list int float weights\nproperty double x\nproperty short "
      "y\n"
      "property char z\nproperty uint64 t\nend_header\n";
  const std::string faces = "\x02\x00\x01\x00\x02\x09"s + "\x00\x09"s;
  const std::string vertex = "\x00\x00\x00\x01\x3f\x80\x00\x00"s + "\xc0\x04\x00\x00\x00\x00\x00\x00"s +
                             "\xff\xfe"s + "\x05"s + "\x00\x00\x00\x00\x00\x00\x01\x00"s;
  const PointCloudFile cloud = read_cloud_text("a.ply", header + faces + vertex);
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points[0].p_lidar, Eigen::Vector3f(-2.5F, -2.0F, 5.0F));
  EXPECT_DOUBLE_EQ(cloud.times_s[0], 256e-9);
}

TEST(PointCloudFile, LeavesOutAndCountsWhatIsNotANumber) {
  const PointCloudFile cloud = read_cloud_text(
      "a.ply",
      ply_of_times("double", "nan 0 0 0\n0 inf 0 0\n0 0 -1.#IND 0\n1e300 0 0 0\n1 2 3 nan\n1 2 3 0.05\n"));
  EXPECT_EQ(cloud.invalid_points, 5U);
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_THAT(cloud.times_s, ElementsAre(0.05));
}

TEST(PointCloudFile, RecognisesTheUnitOfTimes) {
  const auto unit_s = [](const std::string& type, const std::string& first, const std::string& last) {
    return read_cloud_text("a.ply", ply_of_times(type, "1 2 3 " + first + "\n1 2 3 " + last + "\n"))
        .time_unit_s;
  };
  EXPECT_EQ(unit_s("float", "-0.1", "0"), 1.0);
  EXPECT_EQ(unit_s("double", "1700000000.00", "1700000000.05"), 1.0);
  EXPECT_EQ(unit_s("float", "0", "99.9"), 1e-3);
  EXPECT_EQ(unit_s("float", "0", "100000"), 1e-6);
  EXPECT_EQ(unit_s("uint", "0", "50000"), 1e-6);
  EXPECT_EQ(unit_s("uint", "0", "99990000"), 1e-9);
  EXPECT_EQ(unit_s("double", "1.7e18", "1.7000000001e18"), 1e-9);
  EXPECT_EQ(unit_s("double", "1.7e18", "1.7e18"), 1e-9);
  EXPECT_EQ(unit_s("double", "1.7e15", "1.7e15"), 1e-6);
  EXPECT_EQ(unit_s("double", "1.7e12", "1.7e12"), 1e-3);
  EXPECT_EQ(unit_s("double", "1.7e9", "1.7e9"), 1.0);
  EXPECT_EQ(unit_s("uint", "5", "5"), 1e-9);
  EXPECT_EQ(read_cloud_text("a.ply", ply_of_times("float", "")).time_unit_s, 1.0);
}

TEST(PointCloudFile, AnEmptyCloudIsNoError) {
  const std::string header =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\nHEIGHT 0\nPOINTS 0\nDATA ";
  for (const std::string encoding : {"ascii\n", "binary\n", "binary_compressed\n"}) {
    EXPECT_TRUE(read_cloud_text("a.pcd", header + encoding).points.empty()) << encoding;
  }
}

void expect_problem(const std::string& name, const std::string& text, const std::string& problem) {
  EXPECT_THAT([&] { read_cloud_text(name, text); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(name), HasSubstr(problem))));
}

std::string pcd(const std::string& fields, const std::string& counts, const std::string& data) {
  return "VERSION 0.7\nFIELDS " + fields + "\nSIZE 4 4 4\nTYPE F F F\n" + counts + "\nDATA " + data;
}

TEST(PointCloudFile, SaysWhatIsWrongWithAPcdFile) {
  const std::string one = "WIDTH 1\nHEIGHT 1\nPOINTS 1";
  expect_problem("a.pcd", "", "without a line DATA");
  expect_problem("a.pcd", "hello\n", "a.pcd:1: this is no line of a PCD header");
  expect_problem("a.pcd", "VERSION 0.7\nDATA ascii\n", "no line FIELDS");
  expect_problem("a.pcd", pcd("x y", one, "ascii\n"), "a.pcd:3: SIZE has 3 values for 2 fields");
  expect_problem("a.pcd", pcd("a b c", one, "ascii\n1 2 3\n"), "no x, y and z, only: a b c");
  expect_problem("a.pcd", pcd("x y z", "WIDTH 2\nHEIGHT 1\nPOINTS 3", "ascii\n"),
                 "a.pcd:7: POINTS 3 is not WIDTH");
  expect_problem("a.pcd", pcd("x y z", "WIDTH -1\nPOINTS 3", "ascii\n"), "WIDTH needs one whole number");
  expect_problem("a.pcd", pcd("x y z", "", "ascii\n"), "neither POINTS nor WIDTH");
  expect_problem("a.pcd", pcd("x y z", "WIDTH 4294967295\nHEIGHT 4294967295", "binary\n"), "too large");
  expect_problem("a.pcd", pcd("x y z", one, "zip\n"), "DATA must be ascii, binary or binary_compressed");
  expect_problem("a.pcd", pcd("x y z", one, "ascii\n1 2\n"), "a.pcd:9: has fewer values");
  expect_problem("a.pcd", pcd("x y z", one, "ascii\n1 2 3 4\n"), "a.pcd:9: has more values");
  expect_problem("a.pcd", pcd("x y z", one, "ascii\n1 2 3x\n"), "a.pcd:9: '3x' is not a number");
  expect_problem("a.pcd", pcd("x y z", "WIDTH 2", "ascii\n1 2 3\n\n"), "the file ends here");
  expect_problem("a.pcd", pcd("x y z", one, "binary\n12345678901"), "only 11 bytes follow");
  expect_problem("a.pcd", pcd("x y z", "WIDTH 4000000000", "binary\n123"), "announces 4000000000 rows");
  expect_problem("a.pcd", pcd("x y z", one, "binary_compressed\n1234567"), "sizes of the compressed points");
  expect_problem("a.pcd", pcd("x y z", one, "binary_compressed\n\x09\0\0\0\x0c\0\0\0abc"s), "cut off");
  expect_problem("a.pcd", pcd("x y z", one, "binary_compressed\n\x03\0\0\0\x0d\0\0\0abc"s),
                 "not that of the header");
  expect_problem("a.pcd", pcd("x y z", one, "binary_compressed\n\x03\0\0\0\x0c\0\0\0abc"s),
                 "do not decompress");
  expect_problem("a.pcd",
                 pcd("x y z", "WIDTH 300000000",
                     "binary_compressed\n\x03\0\0\0\x00\xa4\x93\xd6"
                     "abc"s),
                 "so few bytes");
}

TEST(PointCloudFile, SaysWhatIsWrongWithAPlyFile) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  expect_problem("a.ply", "", "without a line end_header");
  expect_problem("a.ply", "plyy\n", "a.ply:1: the file does not begin");
  expect_problem("a.ply", "ply\nformat ascii 2.0\n", "a.ply:2: 'format ascii 2.0'");
  expect_problem("a.ply", "ply\nelement vertex many\n", "a.ply:2:");
  expect_problem("a.ply", "ply\nproperty float x\n", "a.ply:2:");
  expect_problem("a.ply", "ply\nelement vertex 1\nproperty real x\n", "a.ply:3:");
  expect_problem("a.ply", "ply\nelement vertex 1\nproperty list float x\n", "a.ply:3:");
  expect_problem("a.ply", "ply\nelement vertex 1\n" + xyz + "end_header\n", "no line format");
  expect_problem("a.ply", "ply\nformat ascii 1.0\nend_header\n", "no element vertex");
  expect_problem("a.ply", "ply\nformat ascii 1.0\nelement vertex 2\n" + xyz + "end_header\n1 2 3\n",
                 "a.ply:8: the file ends here");
  expect_problem("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 9999999999999\n" + xyz + "end_header\n1 2 3\n",
                 "announces 9999999999999 rows");
  expect_problem("a.ply",
                 "ply\nformat ascii 1.0\nelement face 1\nproperty list char int v\nelement vertex 1\n" + xyz +
                     "end_header\n-3 1 2 3\n1 2 3\n",
                 "a.ply:10: a list has a length");
  expect_problem(
      "a.ply",
      "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list float int v\nelement vertex 0\n" +
          xyz + "end_header\nabcd",
      "a list has a length");
}

TEST(PointCloudFile, SaysThatThereIsNoSuchFile) {
  const TempFolder folder;
  EXPECT_THAT([&] { read_point_cloud(folder.path() / "none.pcd"); },
              ThrowsMessage<InputError>(HasSubstr("cannot be opened")));
  EXPECT_THAT([&] { read_point_cloud(folder.path() / "scan.las"); },
              ThrowsMessage<InputError>(HasSubstr("convert it")));
  std::filesystem::create_directory(folder.path() / "folder.ply");
  EXPECT_THAT([&] { read_point_cloud(folder.path() / "folder.ply"); },
              ThrowsMessage<InputError>(HasSubstr("folder.ply")));
}

std::vector<MapPoint> random_map(std::size_t size) {
  std::mt19937 rng(7);
  std::normal_distribution<float> normal(0.0F, 100.0F);
  std::vector<MapPoint> points(size);
  for (MapPoint& point : points) {
    point = {{normal(rng), normal(rng), normal(rng)}, normal(rng), static_cast<MapLabel>(rng() % 5)};
  }
  return points;
}

void expect_same(const std::vector<MapPoint>& read, const std::vector<MapPoint>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].p_map, written[i].p_map);
    EXPECT_EQ(read[i].intensity, written[i].intensity);
    EXPECT_EQ(read[i].label, written[i].label);
  }
}

TEST(MapFile, RoundTrips) {
  const TempFolder folder;
  for (const std::size_t size : {0U, 1U, 1000U}) {
    const std::vector<MapPoint> map = random_map(size);
    write_ply(folder.path() / "map.ply", map);
    expect_same(read_map(folder.path() / "map.ply"), map);
    for (const PcdEncoding encoding : {PcdEncoding::binary, PcdEncoding::binary_compressed}) {
      write_pcd(folder.path() / "map.pcd", map, encoding);
      expect_same(read_map(folder.path() / "map.pcd"), map);
    }
  }
  EXPECT_EQ(count_files(folder.path()), 2U);
}

TEST(MapFile, LabelsThatAreUnknownOrMissingAreUnknown) {
  const TempFolder folder;
  folder.write("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\nproperty int label\nend_header\n1 2 3 4\n1 2 3 5\n1 2 3 -1\n");
  const std::vector<MapPoint> map = read_map(folder.path() / "a.ply");
  ASSERT_EQ(map.size(), 3U);
  EXPECT_EQ(map[0].label, MapLabel::object);
  EXPECT_EQ(map[1].label, MapLabel::unknown);
  EXPECT_EQ(map[2].label, MapLabel::unknown);
  EXPECT_EQ(read_map(fixtures() / "vtk_ascii.ply").at(0).label, MapLabel::unknown);
  EXPECT_EQ(read_map(fixtures() / "pcl_ascii.pcd").size(), 5U);
}

TEST(MapFile, PointsThatAreNotNumbersComeBackAsInvalid) {
  const TempFolder folder;
  write_ply(folder.path() / "map.ply", std::vector<MapPoint>{{{kNanF, 0.0F, 0.0F}, 0.0F, MapLabel::edge}});
  EXPECT_EQ(read_point_cloud(folder.path() / "map.ply").invalid_points, 1U);
}

}  // namespace
}  // namespace mlo
