#include "host/report/job/rod_files.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "host/report/job/table_file.h"

namespace impactdic::report {
namespace {

using Json = nlohmann::ordered_json;

Json measured(const Measured& m) {
  return Json{{"value", json_number(m.value)}, {"sd", json_number(m.sd)}};
}

Json side(const RodSide& s) {
  return Json{{"frames", {s.first, s.last}},
              {"vt_m_s", measured(s.vt_m_s)},
              {"vn_m_s", measured(s.vn_m_s)},
              {"omega_rad_s", measured(s.omega_rad_s)},
              {"angle_deg",
               {{"value", json_number(s.angle_rad.value * kDegPerRad)},
                {"sd", json_number(s.angle_rad.sd * kDegPerRad)}}},
              {"by_differentiation",
               {{"vt_m_s", json_number(s.difference_vt_m_s)},
                {"vn_m_s", json_number(s.difference_vn_m_s)},
                {"omega_rad_s", json_number(s.difference_omega_rad_s)}}},
              {"free_fall",
               {{"gravity_m_s2", measured(s.gravity_m_s2)},
                {"gravity_by_velocity_slope_m_s2", json_number(s.gravity_slope_m_s2)},
                {"tilt_deg", json_number(s.gravity_tilt_deg)}}}};
}

Json closure(const RodClosure& c) {
  return Json{{"normal_impulse_n_s", json_number(c.normal_impulse_n_s)},
              {"tangential_impulse_n_s", json_number(c.tangential_impulse_n_s)},
              {"omega_after_rad_s", measured(c.omega_as_measured_rad_s)},
              {"omega_after_with_axis_flipped_rad_s", measured(c.omega_axis_flipped_rad_s)},
              {"tangential_sign", c.tangential_sign},
              {"misfit_sd", json_number(c.misfit_sd)},
              {"impulse_ratio", measured(c.impulse_ratio)},
              {"inside_friction_cone", c.inside_friction_cone}};
}

Json prediction(const RodPrediction& p) {
  const RodImpact& i = p.impact;
  return Json{{"model", p.model},
              {"restitution", json_number(i.restitution)},
              {"vt_m_s", json_number(i.vt_m_s)},
              {"vn_m_s", json_number(i.vn_m_s)},
              {"omega_rad_s", json_number(i.omega_rad_s)},
              {"contact_s", json_number(i.contact_s)},
              {"start_to_end_s", json_number(i.start_to_end_s)},
              {"micro_impacts", i.micro_impacts},
              {"max_compression_m", json_number(i.max_compression_m)},
              {"residual_m", json_number(i.residual_m)},
              {"max_force_n", json_number(i.max_force_n)},
              {"energy",
               {{"kinetic_before_j", json_number(i.energy.kinetic_before_j)},
                {"kinetic_after_j", json_number(i.energy.kinetic_after_j)},
                {"vibration_after_j", json_number(i.energy.vibration_after_j)},
                {"plastic_j", json_number(i.energy.plastic_j)},
                {"friction_j", json_number(i.energy.friction_j)},
                {"damping_j", json_number(i.energy.damping_j)},
                {"gravity_j", json_number(i.energy.gravity_j)},
                {"residual_j", json_number(i.energy.residual_j)}}},
              {"warnings", i.warnings}};
}

void write_rod_motion(const std::filesystem::path& file, const RodMeasurement& measurement) {
  std::ofstream out(file);
  out << "time_s,status,qt_m,qn_m,out_of_plane_m,angle_12_deg,angle_13_deg,angle_23_deg,angle_deg,"
         "vt_m_s,vn_m_s,omega_rad_s\n";
  for (const RodFrame& f : measurement.frames) {
    out << shortest(f.time_s) << ',' << f.status << ',' << shortest(f.qt_m) << ','
        << shortest(f.qn_m) << ',' << shortest(f.out_of_plane_m);
    for (double angle : f.pair_angle_rad) out << ',' << shortest(angle * kDegPerRad);
    out << ',' << shortest(f.angle_rad * kDegPerRad) << ',' << shortest(f.vt_m_s) << ','
        << shortest(f.vn_m_s) << ',' << shortest(f.omega_rad_s) << '\n';
  }
  close_file(out, file);
}

void write_rod_summary(const std::filesystem::path& file, const std::string& input,
                       const RodMeasureOptions& options, const RodMeasurement& m,
                       const std::vector<RodPrediction>& predictions) {
  Json root{{"input", input},
            {"rod",
             {{"length_m", options.body.length_m},
              {"radius_m", options.body.radius_m},
              {"mass_kg", options.body.mass_kg},
              {"friction_kinetic", options.friction_kinetic}}},
            {"frames", m.frames.size()},
            {"impact_s", measured(m.impact_s)},
            {"position_noise_m", json_number(m.position_noise_m)},
            {"angle_noise_deg", json_number(m.angle_noise_rad * kDegPerRad)},
            {"pair_angle_spread_deg", json_number(m.pair_spread_rad * kDegPerRad)},
            {"before", side(m.before)},
            {"after", side(m.after)},
            {"contact_point",
             {{"vn_before_m_s", measured(m.tip_vn_before_m_s)},
              {"vn_after_m_s", measured(m.tip_vn_after_m_s)}}},
            {"restitution", measured(m.restitution)},
            {"impulse_closure", closure(m.closure)},
            {"predictions", Json::array()},
            {"warnings", m.warnings}};
  for (const RodPrediction& p : predictions) root["predictions"].push_back(prediction(p));
  std::ofstream out(file);
  out << root.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  close_file(out, file);
}

void write_deformations(const std::filesystem::path& file,
                        const std::vector<DeformationComparison>& rows) {
  std::ofstream out(file);
  out << "angle_deg,speed_m_s,depth_m,depth_sd_m,rigid_rod_m,flexible_rod_m\n";
  for (const DeformationComparison& row : rows) {
    out << shortest(row.measured.angle_deg) << ',' << shortest(row.measured.speed_m_s) << ','
        << shortest(row.measured.depth_m) << ',' << shortest(row.measured.depth_sd_m) << ','
        << shortest(row.rigid_m) << ',' << shortest(row.flexible_m) << '\n';
  }
  close_file(out, file);
}

}  // namespace

void write_rod(const std::filesystem::path& folder, const RodRequest& request,
               const RodResult& result) {
  write_rod_motion(folder / "motion.csv", result.measurement);
  write_rod_summary(folder / "summary.json", request.markers.file, request.measure,
                    result.measurement, result.predictions);
  if (!result.deformations.empty()) {
    write_deformations(folder / "deformation.csv", result.deformations);
  }
}

}  // namespace impactdic::report
