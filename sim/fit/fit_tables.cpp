#include "sim/fit/fit_tables.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/job/job_toml.h"

namespace impactdic::sim::fit {
namespace {

constexpr std::array<std::pair<FitMethod, const char*>, 3> kMethods{
    {{FitMethod::kTrajectory, "trajectory"},
     {FitMethod::kPublishedGrid, "published_grid"},
     {FitMethod::kRestitutionDuration, "restitution_duration"}}};
constexpr std::array kLawParameters{
    FitParameter::kStiffness,      FitParameter::kDamping,     FitParameter::kFrictionKinetic,
    FitParameter::kFrictionStatic, FitParameter::kPoisson,     FitParameter::kYieldStrength,
    FitParameter::kDrag,           FitParameter::kLift,        FitParameter::kShellStiffness,
    FitParameter::kShellDamping,   FitParameter::kFlatFraction};
constexpr std::array kShotUnknowns{FitParameter::kContactTime, FitParameter::kSurfaceAngle,
                                   FitParameter::kScale, FitParameter::kRate};

template <typename Candidates>
std::vector<FitParameter> parameters(const Candidates& candidates, job::StrictTable& table,
                                     const std::string& key, NormalModel normal) {
  std::vector<FitParameter> chosen;
  for (const std::string& text : table.texts(key)) {
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](FitParameter p) { return key_of(p, normal) == text; });
    if (found == candidates.end()) {
      std::string list;
      for (FitParameter p : candidates) list += (list.empty() ? "" : ", ") + key_of(p, normal);
      throw InvalidArgument("'" + text + "' cannot be fitted", table.place(key), "one of " + list);
    }
    if (std::find(chosen.begin(), chosen.end(), *found) != chosen.end()) {
      throw InvalidArgument("'" + text + "' stands twice", table.place(key));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

std::vector<std::string> keys_of(const std::vector<FitParameter>& chosen, NormalModel normal) {
  std::vector<std::string> keys;
  for (FitParameter p : chosen) keys.push_back(key_of(p, normal));
  return keys;
}

}  // namespace

FitRequest read_fit_tables(job::StrictTable& root, bool rivals) {
  FitRequest job;
  job.rivals = rivals;
  root.text("normal");  // a forgotten line must not choose a law
  root.text("friction");
  job.impact = job::read_impact_tables(root, true);
  job::StrictTable& body = root.table("body");
  body.number("mass_kg");  // must be there
  body.number("diameter_m");
  job::StrictTable& fit = root.table("fit");
  job.method = choose(kMethods, fit, "method", "trajectory");
  job.parameters = parameters(kLawParameters, fit, "parameters", job.impact.normal);
  if (fit.has("unknowns")) {
    job.unknowns = parameters(kShotUnknowns, fit, "unknowns", job.impact.normal);
  }
  job.flight_frames = fit.integer("flight_frames", job.flight_frames);
  job.outlier_sd = fit.number("outlier_sd", job.outlier_sd);
  job.rivals = fit.boolean("rivals", job.rivals);
  job.scale_sd = fit.number("scale_sd", job.scale_sd);
  job.rate_sd = fit.number("rate_sd", job.rate_sd);
  job::StrictTable& grid = root.table("grid");
  job.grid.stiffness_max = grid.number("stiffness_max", job.grid.stiffness_max);
  job.grid.damping_max_n_s_per_m =
      grid.number("damping_max_n_s_per_m", job.grid.damping_max_n_s_per_m);
  job.grid.stiffness_steps = grid.integer("stiffness_steps", job.grid.stiffness_steps);
  job.grid.damping_steps = grid.integer("damping_steps", job.grid.damping_steps);
  return job;
}

std::vector<std::filesystem::path> read_paths(job::StrictTable& root, const std::string& key,
                                              const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> list;
  for (const std::string& text : root.texts(key)) {
    list.push_back(std::filesystem::absolute(folder / text).lexically_normal());
  }
  return list;
}

std::vector<FitShot> shots_at(const std::vector<std::filesystem::path>& tracks, double angle_deg) {
  std::vector<FitShot> shots;
  for (const auto& track : tracks) shots.push_back({track, angle_deg});
  return shots;
}

double surface_angle(job::StrictTable& root) {
  job::StrictTable& surface = root.table("surface");
  return surface.has("angle_deg") ? surface.number("angle_deg") : kNotMeasured;
}

void write_laws(job::TomlText& text, const ImpactJob& laws) {
  text.name("normal", name_of(laws.normal));
  text.name("friction", name_of(laws.friction));
  text.name("preset", name_of(laws.preset));
}

void write_tracks(job::TomlText& text, const std::string& key, const std::vector<FitShot>& shots) {
  std::vector<std::string> files;
  for (const FitShot& shot : shots) files.push_back(shot.track.string());
  if (!files.empty()) text.names(key, files);
}

void write_fit_tables(job::TomlText& text, const FitRequest& job, double angle_deg) {
  text.body(job.impact.body);
  job::write_contact(text, job.impact);
  if (!std::isnan(angle_deg)) {
    text.table("surface");
    text.number("angle_deg", angle_deg);
  }
  text.table("environment");
  text.number("gravity_m_s2", job.impact.gravity_m_s2);
  job::write_shell(text, job.impact);
  job::write_air(text, job.impact.air);
  text.table("solver");
  text.number("relative_tolerance", job.impact.solver.relative_tolerance);
  text.table("fit");
  text.name("method", name_in(kMethods, job.method));
  text.names("parameters", keys_of(job.parameters, job.impact.normal));
  text.names("unknowns", keys_of(job.unknowns, job.impact.normal));
  text.integer("flight_frames", job.flight_frames);
  text.number("outlier_sd", job.outlier_sd);
  text.boolean("rivals", job.rivals);
  if (!std::isnan(job.scale_sd)) text.number("scale_sd", job.scale_sd);
  if (!std::isnan(job.rate_sd)) text.number("rate_sd", job.rate_sd);
  text.table("grid");
  text.number("stiffness_max", job.grid.stiffness_max);
  text.number("damping_max_n_s_per_m", job.grid.damping_max_n_s_per_m);
  text.integer("stiffness_steps", job.grid.stiffness_steps);
  text.integer("damping_steps", job.grid.damping_steps);
}

}  // namespace impactdic::sim::fit
