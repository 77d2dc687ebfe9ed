#include "host/report/job/fit_files.h"

#include <array>
#include <nlohmann/json.hpp>

#include "host/report/job/table_file.h"

namespace impactdic::report {
namespace {

using Json = nlohmann::ordered_json;

Json estimate(const Measured& e) {
  return {{"value", json_number(e.value)}, {"sd", json_number(e.sd)}};
}

Json flight(const ShotFlight& f) {
  return {{"frames", {f.first, f.last}},
          {"vt_m_s", estimate(f.vt_m_s)},
          {"vn_m_s", estimate(f.vn_m_s)},
          {"omega_rad_s", estimate(f.omega_rad_s)}};
}

Json parameter(const ParameterEstimate& p) {
  return {{"value", json_number(p.value)},
          {"sd", json_number(p.sd)},
          {"ci95", {json_number(p.ci95_low), json_number(p.ci95_high)}},
          {"determined", p.determined},
          {"interval", p.profiled ? "profile_likelihood" : "covariance"},
          {"parts", {{"scale", json_number(p.scale_part)}, {"rate", json_number(p.rate_part)}}},
          {"verdict", p.verdict}};
}

const char* adequacy_name(Adequacy adequacy) {
  switch (adequacy) {
    case Adequacy::kAdequate:
      return "adequate";
    case Adequacy::kInadequate:
      return "inadequate";
    case Adequacy::kNotTested:
      break;
  }
  return "not_tested";
}

Json rivals_json(const std::vector<RivalFit>& rivals) {
  Json list = Json::array();
  for (const RivalFit& rival : rivals) {
    Json json{{"normal", name_of(rival.normal)},
              {"friction", name_of(rival.friction)},
              {"restitution_damping", name_of(rival.restitution_damping)},
              {"shell", rival.shell},
              {"chi_square", json_number(rival.chi_square)},
              {"p_value", json_number(rival.p_value)},
              {"aicc", json_number(rival.aicc)},
              {"above_best", json_number(rival.above_best)},
              {"parameters", Json::object()}};
    for (const ParameterEstimate& p : rival.parameters) {
      json["parameters"][p.key] = json_number(p.value);
    }
    list.push_back(json);
  }
  return list;
}

Json fit_json(const ShotFit& fit) {
  Json json{{"shot", shot_json(fit.shot)}, {"parameters", Json::object()}};
  Json order = Json::array();
  for (const ParameterEstimate& p : fit.parameters) {
    json["parameters"][p.key] = parameter(p);
    order.push_back(p.key);
  }
  Json covariance = Json::array();
  const std::size_t size = fit.parameters.size();
  for (std::size_t i = 0; i < size && fit.covariance.size() == size * size; ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < size; ++j) {
      row.push_back(Json(json_number(fit.covariance[i * size + j])));
    }
    covariance.push_back(row);
  }
  json["covariance"] = {{"order", order}, {"rows", covariance}};
  json["chi_square"] = json_number(fit.chi_square);
  json["measurements"] = fit.measurements;
  json["free_parameters"] = fit.free_parameters;
  json["reduced_chi_square"] = json_number(fit.reduced_chi_square);
  json["p_value"] = json_number(fit.p_value);
  json["adequacy"] = adequacy_name(fit.adequacy);
  if (!fit.rivals.empty()) json["rivals"] = rivals_json(fit.rivals);
  for (const DerivedFigure& d : fit.derived) {
    json["derived"][d.key] = {{"value", json_number(d.value)}, {"sd", json_number(d.sd)}};
  }
  if (!fit.deviation_factors.empty()) {
    json["deviation_factors"] = {{"centre", json_number(fit.deviation_factors[0])},
                                 {"motion", json_number(fit.deviation_factors[1])},
                                 {"rotation", json_number(fit.deviation_factors[2])}};
  }
  json["aic"] = json_number(fit.aic);
  json["rms_m"] = json_number(fit.rms_m);
  json["converged"] = fit.converged;
  json["warnings"] = fit.warnings;
  return json;
}

// One table a shot, in the shots' order: what the model leaves of each measurement.
void write_residuals(const std::filesystem::path& folder, const FitResult& result) {
  constexpr std::array kNames{"x_m", "y_m", "dx_m", "dy_m", "turn_rad"};
  for (std::size_t n = 0; n < result.shots.size(); ++n) {
    if (result.shots[n].residuals.empty()) continue;
    TableFile table(folder / ("residuals_" + std::to_string(n) + ".csv"),
                    "series,time_s,residual,sd");
    for (const FitResidual& r : result.shots[n].residuals) {
      table << std::string(kNames[static_cast<std::size_t>(r.series)]) << r.time_s << r.residual
            << r.sd;
      table.end_row();
    }
    table.close();
  }
}

Json trends_json(const std::vector<ParameterTrend>& trends) {
  Json list = Json::array();
  for (const ParameterTrend& t : trends) {
    list.push_back({{"over", t.over},
                    {"slope", json_number(t.slope)},
                    {"sd", json_number(t.sd)},
                    {"p_value", json_number(t.p_value)}});
  }
  return list;
}

void write_surfaces(const std::filesystem::path& folder, const FitResult& result) {
  for (std::size_t n = 0; n < result.surfaces.size(); ++n) {
    const ErrorSurface& s = result.surfaces[n];
    const std::string key = result.shots[n].parameters[0].key;
    TableFile grid(folder / ("errors_" + std::to_string(n) + ".csv"),
                   key + ",damping_n_s_per_m,displacement_error,velocity_error,product,sum");
    for (std::size_t i = 0; i < s.displacement.size(); ++i) {
      const std::size_t columns = s.damping_n_s_per_m.size();
      grid << s.stiffness[i / columns] << s.damping_n_s_per_m[i % columns] << s.displacement[i]
           << s.velocity[i] << s.displacement[i] * s.velocity[i]
           << s.displacement[i] + s.velocity[i];
      grid.end_row();
    }
    grid.close();
    TableFile fine(folder / ("errors_spline_" + std::to_string(n) + ".csv"),
                   key + ",damping_n_s_per_m,sum");
    for (std::size_t i = 0; i < s.fine_sum.size(); ++i) {
      const std::size_t columns = s.fine_damping.size();
      fine << s.fine_stiffness[i / columns] << s.fine_damping[i % columns] << s.fine_sum[i];
      fine.end_row();
    }
    fine.close();
  }
}

void write_parameters(const std::filesystem::path& file, const FitResult& result) {
  std::string header = "track,surface_angle_deg,vt_before_m_s,vn_before_m_s,restitution,contact_s";
  for (const ParameterEstimate& p : result.shots[0].parameters) {
    header += "," + p.key + "," + p.key + "_sd," + p.key + "_ci95_low," + p.key + "_ci95_high," +
              p.key + "_determined";
  }
  TableFile table(file, header + ",reduced_chi_square,p_value,adequacy,rms_m");
  for (const ShotFit& fit : result.shots) {
    table << fit.shot.file << fit.shot.surface_angle_deg << fit.shot.before.vt_m_s.value
          << fit.shot.before.vn_m_s.value << fit.shot.restitution.value << fit.shot.contact_s.value;
    for (const ParameterEstimate& p : fit.parameters) {
      table << p.value << p.sd << p.ci95_low << p.ci95_high
            << std::string(p.determined ? "1" : "0");
    }
    table << fit.reduced_chi_square << fit.p_value << std::string(adequacy_name(fit.adequacy))
          << fit.rms_m;
    table.end_row();
  }
  table.close();
}

}  // namespace

Json shot_json(const MeasuredShot& s) {
  return {{"track", s.file},
          {"surface_angle_deg", s.surface_angle_deg},
          {"before", flight(s.before)},
          {"after", flight(s.after)},
          {"contact_start_s", estimate(s.contact_start_s)},
          {"contact_s", estimate(s.contact_s)},
          {"t_max_compression_s", json_number(s.t_max_compression_s)},
          {"max_deflection_m", estimate(s.max_deflection_m)},
          {"restitution", estimate(s.restitution)},
          {"effective_friction",
           {{"published", json_number(s.friction.published)},
            {"with_gravity", json_number(s.friction.sound)},
            {"sd", json_number(s.friction_sd)},
            {"rolling_cap", json_number(s.friction.rolling_cap)}}},
          {"noise_m", json_number(s.noise_m)}};
}

Json pooled_json(const std::vector<PooledEstimate>& pooled) {
  Json json = Json::object();
  for (const PooledEstimate& p : pooled) {
    json[p.key] = {
        {"value", json_number(p.value)},
        {"sd", json_number(p.sd)},
        {"ci95", {json_number(p.ci95_low), json_number(p.ci95_high)}},
        {"between",
         {{"sd", json_number(p.between_sd)},
          {"ci95", {json_number(p.between_ci95_low), json_number(p.between_ci95_high)}}}},
        {"trends", trends_json(p.trends)},
        {"warnings", p.warnings},
        {"mean", json_number(p.mean)},
        {"scatter_sd", json_number(p.scatter_sd)},
        {"chi_square", json_number(p.chi_square)},
        {"determined", p.determined},
        {"outliers", p.outliers}};
  }
  return json;
}

Json fits_json(const FitResult& result) {
  Json shots = Json::array();
  for (const ShotFit& fit : result.shots) shots.push_back(fit_json(fit));
  for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
    const ErrorSurface& s = result.surfaces[i];
    shots[i]["grid"] = {{"stiffness", s.grid_stiffness}, {"damping_n_s_per_m", s.grid_damping}};
    shots[i]["spline"] = {{"stiffness", s.spline_stiffness},
                          {"damping_n_s_per_m", s.spline_damping}};
  }
  return shots;
}

void write_fit(const std::filesystem::path& folder, const FitRequest& job,
               const FitResult& result) {
  Json summary{{"normal", name_of(job.impact.normal)},
               {"friction", name_of(job.impact.friction)},
               {"version", IMPACTDIC_VERSION},
               {"parameters", Json::object()}};
  // One shot: its own figures. Several: the pooled ones.
  if (result.shots.size() == 1) {
    summary["parameters"] = fit_json(result.shots[0])["parameters"];
    summary["covariance"] = fit_json(result.shots[0])["covariance"];
  } else {
    summary["parameters"] = pooled_json(result.pooled);
  }
  summary["shots"] = fits_json(result);
  write_ordered_json(folder / "summary.json", summary);
  write_parameters(folder / "parameters.csv", result);
  write_residuals(folder, result);
  write_surfaces(folder, result);
}

}  // namespace impactdic::report
