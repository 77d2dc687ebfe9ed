#include "host/report/job/study_files.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/parse.h"
#include "host/report/job/table_file.h"
#include "host/report/summary.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

constexpr const char* kHeader =
    "pattern,density,motion,dx_px,dy_px,rot_deg,estimator,pairs,pairs_failed,"
    "dx_mean_px,dy_mean_px,rot_mean_deg,dx_abs_px,dy_abs_px,rot_abs_deg,"
    "dx_rms_px,dy_rms_px,rot_rms_deg,dx_sd_px,dy_sd_px,rot_sd_deg,"
    "shift_rms_px,centre_rms_px,bound_dx_px,bound_dy_px,bound_rot_deg,"
    "windows,no_texture_share,failed_share,wrong_share,window_rms_px,window_bound_px,"
    "ms_per_pair";

void write_row(std::ofstream& file, const PatternStudyRow& row) {
  const MotionErrors& e = row.errors;
  const double windows = e.windows;
  file << row.pattern << ',' << shortest(row.density) << ',' << row.motion.name;
  for (const double value : {row.motion.dx_px, row.motion.dy_px, row.motion.rot_deg}) {
    file << ',' << shortest(value);
  }
  file << ',' << row.estimator << ',' << e.pairs << ',' << e.failed_pairs;
  for (const auto part :
       {&ErrorSums::mean, &ErrorSums::mean_abs, &ErrorSums::rms, &ErrorSums::sd}) {
    for (const ErrorSums* sums : {&e.dx_px, &e.dy_px, &e.rot_deg}) {
      file << ',' << number_cell((sums->*part)());
    }
  }
  for (const double value :
       {e.shift_px.rms(), row.centre_px.rms(), row.bound_dx_px, row.bound_dy_px, row.bound_rot_deg,
        windows / e.pairs, e.no_texture / windows, e.failed / windows, e.wrong / windows,
        e.window_px.rms(), e.window_bound_px.rms(), e.seconds * 1e3 / e.pairs}) {
    file << ',' << number_cell(value);
  }
  file << '\n';
}

json describe(const PooledErrors& p) {
  return {{"pairs", p.pairs},
          {"pairs_failed", p.failed_pairs},
          {"motion_rms_px", json_number(p.motion_rms_px)},
          {"rot_rms_deg", json_number(p.rot_rms_deg)},
          {"shift_rms_px", json_number(p.shift_rms_px)},
          {"surface_rms_px", json_number(p.surface_rms_px)},
          {"bound_px", json_number(p.bound_px)},
          {"bound_deg", json_number(p.bound_deg)},
          {"window_rms_px", json_number(p.window_rms_px)},
          {"window_bound_px", json_number(p.window_bound_px)},
          {"no_texture_share", json_number(p.no_texture_share)},
          {"wrong_share", json_number(p.wrong_share)}};
}

void write_pattern_csv(const std::filesystem::path& path,
                       const std::vector<PatternStudyRow>& rows) {
  std::ofstream file(path);
  file << kHeader << '\n';
  for (const PatternStudyRow& row : rows) write_row(file, row);
  close_file(file, path);
}

std::ofstream open(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw FileError("cannot write the file", path.string());
  return file;
}

void write_density_csv(const std::filesystem::path& path, const std::vector<DensityRow>& rows) {
  std::ofstream file = open(path);
  file << "points,method,us_per_window,rms_px,bias_x_px,bias_y_px,same_lag_share\n";
  for (const DensityRow& row : rows) {
    file << row.points << ',' << row.method << ',' << number_cell(row.us_per_window) << ','
         << number_cell(row.rms_px) << ',' << number_cell(row.bias_x_px) << ','
         << number_cell(row.bias_y_px) << ',' << number_cell(row.same_lag_share) << '\n';
  }
  close_file(file, path);
}

void write_window_csv(const std::filesystem::path& path, const Image<double>& picture,
                      double step_px) {
  std::ofstream file = open(path);
  file << "x_px,y_px,grey\n";
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      file << shortest(x * step_px) << ',' << shortest(y * step_px) << ','
           << shortest(picture(x, y)) << '\n';
    }
  }
  close_file(file, path);
}

json describe(const StudyDevice& device) {
  return {{"name", device.name},
          {"platform", device.platform},
          {"driver", device.driver},
          {"count", device.count}};
}

}  // namespace

void write_study(const std::filesystem::path& folder, const PatternStudyRequest& request,
                 const PatternStudyResult& result) {
  write_pattern_csv(folder / "patterns.csv", result.rows);
  json summary = {{"radius_px", request.radius_px},
                  {"noise", request.noise},
                  {"seed", request.seed},
                  {"pairs_per_motion", request.pairs}};
  const PatternFindings& findings = result.findings;
  for (const EstimatorErrors& e : findings.estimators) {
    json& entry = summary["estimators"][e.estimator];
    entry["all"] = describe(e.all);
    for (const auto& [group, pooled] : e.groups) entry["groups"][group] = describe(pooled);
    for (const auto& [name, pooled] : e.patterns) entry["patterns"][name] = describe(pooled);
  }
  summary["best_estimator"] = findings.best_estimator;
  summary["best_pattern"] = findings.best_pattern;
  summary["as_good_patterns"] = findings.as_good_patterns;
  summary["finding"] = findings.finding;
  summary["device"] = describe(result.device);
  summary["seconds"] = result.seconds;
  write_json(folder / "summary.json", summary);
}

void write_study(const std::filesystem::path& folder, const DensityStudyResult& result) {
  write_density_csv(folder / "density.csv", result.rows);
  write_window_csv(folder / "window.csv", result.window, 1);
  const double fine = static_cast<double>(result.window.width() - 1) /
                      static_cast<double>(result.interpolated.width() - 1);
  write_window_csv(folder / "window_spline.csv", result.interpolated, fine);
  const DensityFindings& findings = result.findings;
  json summary = {{"same_lag_share", findings.same_lag_share},
                  {"default_spread", findings.default_spread},
                  {"literal_slowdown", findings.literal_slowdown},
                  {"published_slowdown", findings.published_slowdown}};
  if (findings.literal_growth) summary["literal_growth"] = *findings.literal_growth;
  summary["finding"] = findings.finding;
  summary["device"] = describe(result.device);
  write_json(folder / "summary.json", summary);
}

}  // namespace impactdic::report
