#include "mlo/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "mlo/report/birds_eye.hpp"

namespace mlo {
namespace {

constexpr std::string_view kStyle = R"(<style>
body{font:15px/1.45 system-ui,sans-serif;color:#222;background:#fff;margin:2rem auto;max-width:1280px;padding:0 1.5rem}
h1{font-size:1.7rem;margin:0 0 .3rem}h2{font-size:1.2rem;margin:2.2rem 0 .6rem;border-bottom:1px solid #ccc}
h3{font-size:1rem;margin:1rem 0 .3rem}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.22rem .8rem;border-bottom:1px solid #e4e4e4;text-align:right}
th:first-child,td:first-child{text-align:left;font-weight:normal;color:#555;padding-left:0}
thead th{border-bottom:2px solid #888}
tr.part td{color:#222;font-weight:bold;padding-top:.7rem}
.scroll{overflow-x:auto}
.side{display:grid;grid-template-columns:repeat(auto-fit,minmax(430px,1fr));gap:1.2rem}
.side>*{min-width:0}
svg{max-width:100%;height:auto}
.note{color:#666;font-size:.9rem}.bad{color:#b3261e}
li{margin:.15rem 0}
@media print{
 body{margin:0;max-width:none;padding:0;font-size:10pt}
 h2,h3{break-after:avoid}table,svg,.run{break-inside:avoid}
 .side{grid-template-columns:repeat(2,1fr)}.scroll{overflow:visible}
 @page{margin:15mm}
}
</style>
)";

/// A row of the overview: a title over a part of it, or a name and one cell per run.
struct Row {
  std::string name;
  std::vector<std::string> cells;  // none: a title
};

struct KnownCounter {
  std::string_view name;  // in run.json
  std::string_view words;
};
constexpr KnownCounter kCounters[] = {{"predicted", "lost (pose predicted)"},
                                      {"failed_consistency_checks", "consistency checks without a set"},
                                      {"path_m", "path [m]"},
                                      {"static_map_points", "points of the static map"},
                                      {"peak_memory_mib", "peak memory [MiB]"}};

std::string in_words(std::string name) {
  for (const KnownCounter& counter : kCounters) {
    if (counter.name == name) return std::string(counter.words);
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string number(double value) {
  if (!std::isfinite(value)) return "-";
  return value == std::floor(value) ? fmt::format("{:.0f}", value) : fmt::format("{:.1f}", value);
}

std::string cell(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::vector<std::string> cells_of(std::span<const ReportedRun> runs,
                                  const std::function<std::string(const ReportedRun&)>& text) {
  std::vector<std::string> cells;
  for (const ReportedRun& run : runs) cells.push_back(text(run));
  return cells;
}

void add_counters(std::span<const ReportedRun> runs, std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const ReportedRun& run : runs) {
    for (const auto& [name, value] : run.run.counters) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  for (const std::string& name : names) {
    rows.push_back({in_words(name), cells_of(runs, [&](const ReportedRun& run) {
                      for (const auto& [key, value] : run.run.counters) {
                        if (key == name) return number(value);
                      }
                      return std::string("-");
                    })});
  }
}

void add_errors(std::span<const ReportedRun> runs, std::vector<Row>& rows) {
  if (std::none_of(runs.begin(), runs.end(), [](const ReportedRun& run) { return run.errors.has_value(); }))
    return;
  rows.push_back({"Errors against the truth", {}});
  const auto add = [&](const char* name, const std::function<std::string(const TrajectoryErrors&)>& text) {
    rows.push_back({name, cells_of(runs, [&](const ReportedRun& run) {
                      return run.errors ? text(run.errors->errors) : std::string("-");
                    })});
  };
  rows.push_back({"truth", cells_of(runs, [](const ReportedRun& run) {
                    return run.truth_name.empty() ? std::string("-") : run.truth_name;
                  })});
  add("ATE [m]", [](const TrajectoryErrors& e) { return cell(e.ate_m, 3); });
  add("RTE [m/frame]", [](const TrajectoryErrors& e) { return cell(e.rte_m_per_frame, 4); });
  add("RRE [deg/frame]", [](const TrajectoryErrors& e) { return cell(e.rre_deg_per_frame, 4); });
  add("end point [m]", [](const TrajectoryErrors& e) { return cell(e.end_point_error_m, 2); });
  const auto segments = [](const TrajectoryErrors& e, double SegmentErrors::*measure, int digits) {
    return e.segments.count == 0 ? std::string("-") : fmt::format("{:.{}f}", e.segments.*measure, digits);
  };
  add("KITTI translation [%]",
      [&](const TrajectoryErrors& e) { return segments(e, &SegmentErrors::translation_percent, 3); });
  add("KITTI rotation [deg/m]",
      [&](const TrajectoryErrors& e) { return segments(e, &SegmentErrors::rotation_deg_per_m, 5); });
}

void add_times(std::span<const ReportedRun> runs, std::vector<Row>& rows) {
  rows.push_back({"Times per scan [ms]", {}});
  const auto add = [&](const char* name, double StageSeries::*measure) {
    rows.push_back({name, cells_of(runs, [&](const ReportedRun& run) {
                      return fmt::format("{:.1f}", run.run.whole_scan.*measure);
                    })});
  };
  add("mean", &StageSeries::mean_ms);
  add("median", &StageSeries::p50_ms);
  add("99 %", &StageSeries::p99_ms);
  add("largest", &StageSeries::max_ms);
}

std::string table(const std::vector<std::string>& heads, const std::vector<Row>& rows) {
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& head : heads) html += fmt::format("<th>{}</th>", html_escaped(head));
  html += "</tr></thead><tbody>\n";
  for (const Row& row : rows) {
    if (row.cells.empty()) {
      html += fmt::format("<tr class=\"part\"><td colspan=\"{}\">{}</td></tr>\n", heads.size(),
                          html_escaped(row.name));
      continue;
    }
    html += fmt::format("<tr><td>{}</td>", html_escaped(row.name));
    for (const std::string& text : row.cells) html += fmt::format("<td>{}</td>", html_escaped(text));
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string overview(std::span<const ReportedRun> runs) {
  std::vector<Row> rows;
  rows.push_back({"sequence", cells_of(runs, [](const ReportedRun& run) {
                    return run.run.input_sequence.empty() ? run.run.input_format : run.run.input_sequence;
                  })});
  rows.push_back({"boxes from", cells_of(runs, [](const ReportedRun& run) {
                    return run.run.boxes_from.empty() ? std::string("-") : run.run.boxes_from;
                  })});
  add_counters(runs, rows);
  add_errors(runs, rows);
  add_times(runs, rows);
  std::vector<std::string> heads{""};
  for (const ReportedRun& run : runs) heads.push_back(run.run.name);
  return "<h2>Overview</h2>\n" + table(heads, rows);
}

// Paths of runs without truth, in one panel.
PlotPanel path_panel(const std::vector<const ReportedRun*>& runs) {
  PlotPanel panel{"Path seen from above", "x [m]", "y [m]", true, {}};
  for (std::size_t k = 0; k < runs.size(); ++k) {
    PlotCurve curve{runs[k]->run.name, k + 1, {}};
    for (const SE3& pose : runs[k]->run.trajectory.T_world_body)
      curve.points.emplace_back(pose.translation().head<2>());
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

// Runs on the same scans share their plots.
std::string trajectories(std::span<const ReportedRun> runs) {
  std::vector<std::string> inputs;
  std::map<std::string, std::vector<const ReportedRun*>> groups;
  for (const ReportedRun& run : runs) {
    if (!groups.contains(run.run.input_folder)) inputs.push_back(run.run.input_folder);
    groups[run.run.input_folder].push_back(&run);
  }
  std::string html = "<h2>Trajectories</h2>\n";
  for (const std::string& input : inputs) {
    const std::vector<const ReportedRun*>& group = groups.at(input);
    std::vector<TrajectoryEvaluation> evaluations;
    for (const ReportedRun* run : group) {
      if (run->errors) evaluations.push_back(*run->errors);
    }
    std::vector<PlotPanel> panels;
    if (evaluations.size() == group.size()) {
      panels = trajectory_panels(evaluations, GroundPlane::xy);
    } else {
      panels.push_back(path_panel(group));
    }
    html += fmt::format("<h3>{}</h3>\n", html_escaped(input));
    html += "<div class=\"side\">\n";
    for (const PlotPanel& panel : panels) html += svg_plot({&panel, 1});
    html += "</div>\n";
  }
  return html;
}

std::string stage_times(const ReportedRun& reported) {
  const RunFolder& run = reported.run;
  std::vector<Row> rows;
  PlotPanel panel{"Time of each stage", "frame", "[ms]", false, {}};
  for (std::size_t k = 0; k < run.stages.size(); ++k) {
    const StageSeries& stage = run.stages[k];
    rows.push_back({stage.name,
                    {fmt::format("{:.1f}", stage.mean_ms), fmt::format("{:.1f}", stage.p50_ms),
                     fmt::format("{:.1f}", stage.p99_ms), fmt::format("{:.1f}", stage.max_ms)}});
    PlotCurve curve{stage.name, k + 1, {}};
    for (std::size_t i = 0; i < stage.ms.size() && i < run.frames.size(); ++i) {
      curve.points.emplace_back(run.frames[i], stage.ms[i]);
    }
    panel.curves.push_back(std::move(curve));
  }
  return fmt::format("<div class=\"run\"><h3>{}</h3>\n", html_escaped(run.name)) +
         table({"stage", "mean [ms]", "median", "99 %", "largest"}, rows) + svg_plot({&panel, 1}) +
         "</div>\n";
}

std::string from_above(const ReportedRun& reported) {
  const RunFolder& run = reported.run;
  return fmt::format("<div class=\"run\"><h3>{}</h3>\n", html_escaped(run.name)) +
         birds_eye_svg(run.map, run.trajectory.T_world_body, run.objects) +
         fmt::format("<p class=\"note\">{} points of the map, {} poses, {} poses of objects.</p></div>\n",
                     run.map.size(), run.trajectory.T_world_body.size(), run.objects.size());
}

std::string warnings(const ReportedRun& reported) {
  const RunFolder& run = reported.run;
  std::string html = fmt::format("<div class=\"run\"><h3>{}</h3>\n", html_escaped(run.name));
  if (run.warnings.empty() && run.problems.empty()) return html + "<p class=\"note\">None.</p></div>\n";
  html += "<ul>\n";
  for (const auto* sentences : {&run.warnings, &run.problems}) {
    for (const std::string& sentence : *sentences) {
      html += fmt::format("<li class=\"bad\">{}</li>\n", html_escaped(sentence));
    }
  }
  return html + "</ul></div>\n";
}

std::string side_by_side(const char* title, const char* note, std::span<const ReportedRun> runs,
                         const std::function<std::string(const ReportedRun&)>& part) {
  std::string html =
      fmt::format("<h2>{}</h2>\n<p class=\"note\">{}</p>\n<div class=\"side\">\n", title, note);
  for (const ReportedRun& run : runs) html += part(run);
  return html + "</div>\n";
}

}  // namespace

std::string html_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string report_page(std::span<const ReportedRun> runs) {
  std::string names;
  for (const ReportedRun& run : runs) names += (names.empty() ? "" : ", ") + run.run.name;
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>MLO: {}</title>\n{}</head>\n<body>\n"
      "<h1>Multi-object lidar odometry</h1>\n<p class=\"note\">{} {}: {}. Lidar frame of the first scan; see "
      "docs/evaluation.md for the measures.</p>\n",
      html_escaped(names), kStyle, runs.size(), runs.size() == 1 ? "run" : "runs", html_escaped(names));
  html += overview(runs);
  html += trajectories(runs);
  html += side_by_side("From above",
                       "Ground light, what stands dark; the path blue from its dot, moving objects orange, "
                       "standing ones green.",
                       runs, from_above);
  html += side_by_side("Times", "Wall time of each stage, scan by scan.", runs, stage_times);
  html += side_by_side("Warnings", "What the runs warned of, and scans that they left out.", runs, warnings);
  return html + "</body>\n</html>\n";
}

}  // namespace mlo
