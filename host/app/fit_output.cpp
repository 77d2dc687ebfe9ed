#include "host/app/fit_output.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/parse.h"

namespace impactdic::app {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json estimate(const Estimate& e) { return {{"value", number(e.value)}, {"sd", number(e.sd)}}; }

// A CSV file that reports when it cannot be written.
class Table {
 public:
  Table(const std::filesystem::path& file, const std::string& header) : file_(file), out_(file) {
    out_ << header << '\n';
  }
  Table& operator<<(double value) { return *this << shortest(value); }
  Table& operator<<(const std::string& text) {
    out_ << (first_ ? "" : ",") << text;
    first_ = false;
    return *this;
  }
  void end_row() {
    out_ << '\n';
    first_ = true;
  }
  void close() {
    out_.flush();
    if (!out_) throw FileError("cannot write the file", file_.string());
  }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  bool first_ = true;
};

void write_json(const std::filesystem::path& file, const Json& json) {
  std::ofstream out(file);
  out << json.dump(2) << '\n' << std::flush;
  if (!out) throw FileError("cannot write the file", file.string());
}

Json flight(const Flight& f) {
  return {{"frames", {f.first, f.last}},
          {"vt_m_s", estimate(f.vt_m_s)},
          {"vn_m_s", estimate(f.vn_m_s)},
          {"omega_rad_s", estimate(f.omega_rad_s)}};
}

Json shot_json(const Shot& s) {
  return {{"track", s.file},
          {"surface_angle_deg", s.surface_angle_deg},
          {"before", flight(s.before)},
          {"after", flight(s.after)},
          {"contact_start_s", estimate(s.contact_start_s)},
          {"contact_s", estimate(s.contact_s)},
          {"t_max_compression_s", number(s.t_max_compression_s)},
          {"max_deflection_m", estimate(s.max_deflection_m)},
          {"restitution", estimate(s.restitution)},
          {"effective_friction",
           {{"published", number(s.friction.published)},
            {"with_gravity", number(s.friction.sound)},
            {"sd", number(s.friction_sd)},
            {"rolling_cap", number(s.friction.rolling_cap)}}},
          {"noise_m", number(s.noise_m)}};
}

Json parameter(const ParameterEstimate& p) {
  return {{"value", number(p.value)},
          {"sd", number(p.sd)},
          {"ci95", {number(p.ci95_low), number(p.ci95_high)}},
          {"determined", p.determined},
          {"interval", p.profiled ? "profile_likelihood" : "covariance"},
          {"verdict", p.verdict}};
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
    for (std::size_t j = 0; j < size; ++j) row.push_back(number(fit.covariance[i * size + j]));
    covariance.push_back(row);
  }
  json["covariance"] = {{"order", order}, {"rows", covariance}};
  json["chi_square"] = number(fit.chi_square);
  json["measurements"] = fit.measurements;
  json["free_parameters"] = fit.free_parameters;
  json["reduced_chi_square"] = number(fit.reduced_chi_square);
  if (!fit.deviation_factors.empty()) {
    json["deviation_factors"] = {{"centre", number(fit.deviation_factors[0])},
                                 {"motion", number(fit.deviation_factors[1])},
                                 {"rotation", number(fit.deviation_factors[2])}};
  }
  json["aic"] = number(fit.aic);
  json["rms_m"] = number(fit.rms_m);
  json["converged"] = fit.converged;
  json["warnings"] = fit.warnings;
  return json;
}

Json pooled_json(const std::vector<PooledEstimate>& pooled) {
  Json json = Json::object();
  for (const PooledEstimate& p : pooled) {
    json[p.key] = {
        {"value", number(p.value)},
        {"sd", number(p.sd)},
        {"ci95",
         {number(p.value - 1.959963984540054 * p.sd), number(p.value + 1.959963984540054 * p.sd)}},
        {"mean", number(p.mean)},
        {"scatter_sd", number(p.scatter_sd)},
        {"chi_square", number(p.chi_square)},
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

void write_surfaces(const std::filesystem::path& folder, const FitResult& result) {
  for (std::size_t n = 0; n < result.surfaces.size(); ++n) {
    const ErrorSurface& s = result.surfaces[n];
    const std::string key = result.shots[n].parameters[0].key;
    Table grid(folder / ("errors_" + std::to_string(n) + ".csv"),
               key + ",damping_n_s_per_m,displacement_error,velocity_error,product,sum");
    for (std::size_t i = 0; i < s.displacement.size(); ++i) {
      const std::size_t columns = s.damping_n_s_per_m.size();
      grid << s.stiffness[i / columns] << s.damping_n_s_per_m[i % columns] << s.displacement[i]
           << s.velocity[i] << s.displacement[i] * s.velocity[i]
           << s.displacement[i] + s.velocity[i];
      grid.end_row();
    }
    grid.close();
    Table fine(folder / ("errors_spline_" + std::to_string(n) + ".csv"),
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
  Table table(file, header + ",reduced_chi_square,rms_m");
  for (const ShotFit& fit : result.shots) {
    table << fit.shot.file << fit.shot.surface_angle_deg << fit.shot.before.vt_m_s.value
          << fit.shot.before.vn_m_s.value << fit.shot.restitution.value << fit.shot.contact_s.value;
    for (const ParameterEstimate& p : fit.parameters) {
      table << p.value << p.sd << p.ci95_low << p.ci95_high
            << std::string(p.determined ? "1" : "0");
    }
    table << fit.reduced_chi_square << fit.rms_m;
    table.end_row();
  }
  table.close();
}

void write_comparison_table(const std::filesystem::path& file, const CompareResult& result) {
  Table table(file,
              "track,surface_angle_deg,model,friction_kinetic,vt_before_m_s,vn_before_m_s,"
              "omega_before_rad_s,vt_measured_m_s,vn_measured_m_s,omega_measured_rad_s,vt_m_s,"
              "vn_m_s,omega_rad_s,vt_error,vn_error,omega_error,contact_s,t_max_compression_s,"
              "rms_m,chi_square,aic");
  for (const ComparedShot& c : result.shots) {
    const Flight& before = c.shot.before;
    const Flight& after = c.shot.after;
    for (const ModelOutcome& m : c.models) {
      table << c.shot.file << c.shot.surface_angle_deg << std::string(name_of(m.model))
            << m.friction_kinetic << before.vt_m_s.value << before.vn_m_s.value
            << before.omega_rad_s.value << after.vt_m_s.value << after.vn_m_s.value
            << after.omega_rad_s.value << m.vt_m_s << m.vn_m_s << m.omega_rad_s << m.vt_error
            << m.vn_error << m.omega_error << m.contact_s << m.t_max_compression_s << m.rms_m
            << m.chi_square << m.aic;
      table.end_row();
    }
  }
  table.close();
}

void write_restitution(const std::filesystem::path& folder, const CompareResult& result) {
  Table table(folder / "restitution.csv",
              "track,surface_angle_deg,speed_m_s,vn_before_m_s,restitution,restitution_sd,"
              "friction_published,friction_with_gravity,friction_sd,rolling_cap");
  for (const ComparedShot& c : result.shots) {
    const Shot& s = c.shot;
    table << s.file << s.surface_angle_deg
          << std::hypot(s.before.vt_m_s.value, s.before.vn_m_s.value) << s.before.vn_m_s.value
          << s.restitution.value << s.restitution.sd << s.friction.published << s.friction.sound
          << s.friction_sd << s.friction.rolling_cap;
    table.end_row();
  }
  table.close();
  Table angles(folder / "restitution_by_angle.csv",
               "surface_angle_deg,shots,restitution,restitution_scatter_sd,friction_published,"
               "friction_published_scatter_sd,friction_with_gravity,"
               "friction_with_gravity_scatter_sd,rolling_cap");
  for (const AngleAverage& a : result.angles) {
    angles << a.surface_angle_deg << static_cast<double>(a.shots) << a.restitution.value
           << a.restitution.sd << a.friction_published.value << a.friction_published.sd
           << a.friction_sound.value << a.friction_sound.sd << a.rolling_cap.value;
    angles.end_row();
  }
  angles.close();
}

Json outcome_json(const ModelOutcome& m) {
  Json phases = Json::array();
  for (const Phase& phase : m.phases) {
    phases.push_back({{"name", phase.name}, {"start_s", phase.start_s}, {"end_s", phase.end_s}});
  }
  return {
      {"model", name_of(m.model)},
      {"friction_kinetic", m.friction_kinetic},
      {"final",
       {{"vt_m_s", number(m.vt_m_s)},
        {"vn_m_s", number(m.vn_m_s)},
        {"omega_rad_s", number(m.omega_rad_s)}}},
      {"relative_error",
       {{"vt", number(m.vt_error)}, {"vn", number(m.vn_error)}, {"omega", number(m.omega_error)}}},
      {"contact_s", number(m.contact_s)},
      {"t_max_compression_s", number(m.t_max_compression_s)},
      {"phases", phases},
      {"rms_m", number(m.rms_m)},
      {"chi_square", number(m.chi_square)},
      {"aic", number(m.aic)}};
}

}  // namespace

void write_fit(const std::filesystem::path& folder, const FitJob& job, const FitResult& result) {
  Json summary{{"normal", name_of(job.impact.normal)},
               {"friction", name_of(job.impact.friction)},
               {"parameters", Json::object()}};
  // One shot: its own figures. Several: the pooled ones.
  if (result.shots.size() == 1) {
    summary["parameters"] = fit_json(result.shots[0])["parameters"];
    summary["covariance"] = fit_json(result.shots[0])["covariance"];
  } else {
    summary["parameters"] = pooled_json(result.pooled);
  }
  summary["shots"] = fits_json(result);
  write_json(folder / "summary.json", summary);
  write_parameters(folder / "parameters.csv", result);
  write_surfaces(folder, result);
}

void write_comparison(const std::filesystem::path& folder, const CompareJob& job,
                      const CompareResult& result) {
  const Contact& contact = result.laws.contact;
  Json summary{{"normal", name_of(job.calibration.impact.normal)},
               {"contact",
                {{key_of(FitParameter::kStiffness, job.calibration.impact.normal),
                  number(contact.stiffness)},
                 {"damping_n_s_per_m", number(contact.damping_n_s_per_m)},
                 {"friction_kinetic", number(contact.friction_kinetic)}}},
               {"calibration", nullptr},
               {"shots", Json::array()}};
  if (!result.calibration.shots.empty()) {
    summary["calibration"] = {{"parameters", pooled_json(result.calibration.pooled)},
                              {"shots", fits_json(result.calibration)}};
  }
  for (const ComparedShot& c : result.shots) {
    Json models = Json::array();
    for (const ModelOutcome& m : c.models) models.push_back(outcome_json(m));
    summary["shots"].push_back({{"measured", shot_json(c.shot)}, {"models", models}});
  }
  write_json(folder / "summary.json", summary);
  write_comparison_table(folder / "comparison.csv", result);
  write_restitution(folder, result);
}

}  // namespace impactdic::app
