#include "mlo/io/dataset_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "mlo/core/parallel.hpp"
#include "mlo/io/sequence_files.hpp"

namespace mlo {
namespace {

// What is kept of one scan.
struct ScanSummary {
  std::size_t frame = 0;
  std::string problem;
  bool missing = false;
  std::size_t points = 0;
  std::size_t invalid_points = 0;
  std::size_t rings = 0;
  Spread range_m;
  Spread sweep_fraction;
  bool motion_compensated = false;
};

ScanSummary summarize(const ScanReading& reading, std::size_t frame) {
  ScanSummary summary;
  summary.frame = frame;
  summary.problem = reading.problem;
  summary.missing = reading.missing;
  summary.invalid_points = reading.invalid_points;
  if (!reading.scan) return summary;
  std::vector<double> ranges_m;
  std::vector<double> fractions;
  std::set<std::uint16_t> rings;
  std::uint16_t last_ring = Point::kNoRing;
  for (const Point& point : reading.scan->points) {
    ranges_m.push_back(point.p_lidar.norm());
    fractions.push_back(point.sweep_fraction);
    if (point.ring != last_ring) rings.insert(point.ring);
    last_ring = point.ring;
  }
  rings.erase(Point::kNoRing);
  summary.points = reading.scan->points.size();
  summary.rings = rings.size();
  summary.range_m = spread_of(std::move(ranges_m));
  summary.sweep_fraction = spread_of(std::move(fractions));
  summary.motion_compensated = reading.scan->motion_compensated;
  return summary;
}

// Evenly spread places out of count, first and last included; all of them if max_places is 0 or enough.
std::vector<std::size_t> sample(std::size_t count, std::size_t max_places) {
  const std::size_t places = max_places == 0 ? count : std::min(count, max_places);
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < places; ++k) {
    result.push_back(places == 1 ? 0 : k * (count - 1) / (places - 1));
  }
  return result;
}

template <class Value>
std::vector<double> values_of(const std::vector<ScanSummary>& scans, Value value) {
  std::vector<double> values;
  for (const ScanSummary& scan : scans) values.push_back(static_cast<double>(value(scan)));
  return values;
}

Spread combined(const std::vector<ScanSummary>& scans, Spread ScanSummary::*member) {
  return {spread_of(values_of(scans, [&](const ScanSummary& scan) { return (scan.*member).min; })).min,
          spread_of(values_of(scans, [&](const ScanSummary& scan) { return (scan.*member).median; })).median,
          spread_of(values_of(scans, [&](const ScanSummary& scan) { return (scan.*member).max; })).max};
}

void describe_stamps(const Dataset& dataset, DatasetReport& report) {
  constexpr double kGapPeriods = 1.5;
  const std::vector<double>& stamps_s = dataset.stamps_s;
  if (stamps_s.size() < 2) return;
  const double period_s = median_period_s(stamps_s, 0.0);
  report.duration_s = stamps_s.back() - stamps_s.front();
  report.rate_hz = period_s > 0.0 ? 1.0 / period_s : 0.0;
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    const double length_s = stamps_s[i] - stamps_s[i - 1];
    if (length_s > kGapPeriods * period_s) report.gaps.push_back({dataset.scans->frame(i - 1), length_s});
  }
}

void describe_truth(const std::optional<PoseList>& truth, DatasetReport& report) {
  if (!truth) return;
  report.poses = truth->T_world_body.size();
  for (std::size_t i = 1; i < report.poses; ++i) {
    report.path_m += (truth->T_world_body[i].translation() - truth->T_world_body[i - 1].translation()).norm();
  }
}

// One sentence for all scans of a kind, naming the first few.
void add_finding(std::vector<std::string>& findings, const std::vector<std::size_t>& frames,
                 const std::string& what) {
  constexpr std::size_t kNamed = 5;
  if (frames.empty()) return;
  std::string named;
  for (std::size_t i = 0; i < std::min(kNamed, frames.size()); ++i) {
    named += fmt::format("{}{}", i > 0 ? ", " : "", frames[i]);
  }
  findings.push_back(fmt::format("{} {} {}: frame {}{}", frames.size(), frames.size() == 1 ? "scan" : "scans",
                                 what, named, frames.size() > kNamed ? ", ..." : ""));
}

template <class Test>
std::vector<std::size_t> frames_where(const std::vector<ScanSummary>& scans, Test test) {
  std::vector<std::size_t> frames;
  for (const ScanSummary& scan : scans) {
    if (test(scan)) frames.push_back(scan.frame);
  }
  return frames;
}

// Missing scans are among the dataset's own warnings already.
void count_problems(const std::vector<ScanSummary>& scans, DatasetReport& report) {
  constexpr std::size_t kNamed = 10;
  for (const ScanSummary& scan : scans) {
    report.invalid_points += scan.invalid_points;
    report.motion_compensated |= scan.motion_compensated;
    report.scans_missing += scan.missing;
    if (scan.problem.empty() || scan.missing) continue;
    if (++report.scans_unreadable <= kNamed) report.findings.push_back(scan.problem);
  }
  if (report.scans_unreadable > kNamed) {
    report.findings.push_back(fmt::format("{} more scans cannot be read", report.scans_unreadable - kNamed));
  }
}

void judge_scans(const std::vector<ScanSummary>& scans, DatasetReport& report) {
  constexpr double kMuchInvalid = 0.01;
  constexpr double kFewPoints = 0.5;
  constexpr double kFewRings = 0.9;
  std::vector<std::string>& findings = report.findings;
  add_finding(findings,
              frames_where(scans,
                           [](const ScanSummary& scan) {
                             const auto all = static_cast<double>(scan.points + scan.invalid_points);
                             return static_cast<double>(scan.invalid_points) > kMuchInvalid * all;
                           }),
              "with over 1 % of their points NaN, infinite or at the origin");
  add_finding(findings,
              frames_where(scans,
                           [&](const ScanSummary& scan) {
                             return static_cast<double>(scan.points) < kFewPoints * report.points.median;
                           }),
              fmt::format("with fewer than half of the usual {:.0f} points", report.points.median));
  add_finding(findings,
              frames_where(scans,
                           [&](const ScanSummary& scan) {
                             return scan.rings > 0 &&
                                    static_cast<double>(scan.rings) < kFewRings * report.rings.median;
                           }),
              fmt::format("with fewer than the usual {:.0f} scan lines (an incomplete revolution?)",
                          report.rings.median));
  add_finding(findings, frames_where(scans, [](const ScanSummary& scan) { return scan.rings == 0; }),
              "whose points are not stored line by line and have no ring: scan lines are unknown");
}

void judge_units(DatasetReport& report) {
  constexpr double kNearest = 0.5;
  constexpr double kFarthest = 200.0;
  constexpr double kSlowestHz = 0.5;
  constexpr double kFastestHz = 100.0;
  const double range_m = report.range_m.median;
  if (report.points.max > 0.0 && (range_m < kNearest || range_m > kFarthest)) {
    report.findings.push_back(
        fmt::format("half of the points are beyond {:g} m: are coordinates in metres?", range_m));
  }
  if (report.rate_hz > 0.0 && (report.rate_hz < kSlowestHz || report.rate_hz > kFastestHz)) {
    report.findings.push_back(
        fmt::format("scans are {:g} s apart: are times in seconds?", 1.0 / report.rate_hz));
  }
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  return {*min, *middle, *max};
}

DatasetReport report_on(const Dataset& dataset, std::size_t max_scans) {
  DatasetReport report;
  report.scans = dataset.scans->size();
  report.findings = dataset.warnings;
  describe_truth(dataset.truth, report);
  if (report.scans == 0) {
    report.findings.emplace_back("there is no scan");
    return report;
  }
  report.first_frame = dataset.scans->frame(0);
  report.last_frame = dataset.scans->frame(report.scans - 1);
  describe_stamps(dataset, report);

  const std::vector<std::size_t> places = sample(report.scans, max_scans);
  std::vector<ScanSummary> scans(places.size());
  parallel_for_each_index(places.size(), [&](std::size_t k) {
    scans[k] = summarize(dataset.scans->read(places[k]), dataset.scans->frame(places[k]));
  });
  report.scans_read = scans.size();
  count_problems(scans, report);
  std::erase_if(scans, [](const ScanSummary& scan) { return !scan.problem.empty(); });
  report.points = spread_of(values_of(scans, [](const ScanSummary& scan) { return scan.points; }));
  report.rings = spread_of(values_of(scans, [](const ScanSummary& scan) { return scan.rings; }));
  report.range_m = combined(scans, &ScanSummary::range_m);
  report.sweep_fraction = combined(scans, &ScanSummary::sweep_fraction);
  judge_scans(scans, report);
  judge_units(report);
  return report;
}

DetectionReport report_on_detections(const Dataset& dataset, const DetectionList& detections) {
  constexpr std::size_t kScansChecked = 10;
  DetectionReport report;
  std::vector<std::size_t> with_boxes;
  const auto boxes_of = [&](std::size_t index) {
    const double stamp_s = index < dataset.stamps_s.size() ? dataset.stamps_s[index] : kNoStamp;
    return detections.at(dataset.scans->frame(index), stamp_s);
  };
  for (std::size_t index = 0; index < dataset.scans->size(); ++index) {
    const std::span<const DetectionRecord> records = boxes_of(index);
    if (!records.empty()) with_boxes.push_back(index);
    report.boxes += records.size();
    for (const DetectionRecord& record : records) {
      ++report.by_class[std::string(to_string(record.detection.object_class))];
    }
  }
  report.scans = with_boxes.size();

  const std::vector<std::size_t> places = sample(with_boxes.size(), kScansChecked);
  std::vector<ScanReading> readings(places.size());
  parallel_for_each_index(places.size(),
                          [&](std::size_t k) { readings[k] = dataset.scans->read(with_boxes[places[k]]); });
  std::vector<ScanWithDetections> scans;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::optional<Scan>& read = readings[k].scan;
    if (!read) continue;
    ScanWithDetections& scan = scans.emplace_back();
    scan.points = read->points;
    for (const DetectionRecord& record : boxes_of(with_boxes[places[k]])) {
      scan.detections.push_back(record.detection);
    }
  }
  report.check = check_detections(scans, dataset.calibration);
  return report;
}

}  // namespace mlo
