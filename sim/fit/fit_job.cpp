#include "sim/fit/fit_job.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/error.h"
#include "host/base/parse.h"
#include "host/base/units.h"
#include "sim/impact/job_toml.h"
#include "sim/impact/strict_toml.h"

namespace impactdic {
namespace {

constexpr std::array<std::pair<FitMethod, const char*>, 3> kMethods{
    {{FitMethod::kTrajectory, "trajectory"},
     {FitMethod::kPublishedGrid, "published_grid"},
     {FitMethod::kRestitutionDuration, "restitution_duration"}}};
constexpr std::array<std::pair<FrictionSource, const char*>, 3> kFrictionSources{
    {{FrictionSource::kJob, "job"},
     {FrictionSource::kEffectivePublished, "effective_published"},
     {FrictionSource::kEffectiveSound, "effective_sound"}}};
constexpr std::array kLawParameters{FitParameter::kStiffness,       FitParameter::kDamping,
                                    FitParameter::kFrictionKinetic, FitParameter::kFrictionStatic,
                                    FitParameter::kPoisson,         FitParameter::kYieldStrength};
constexpr std::array kShotUnknowns{FitParameter::kContactTime, FitParameter::kSurfaceAngle,
                                   FitParameter::kScale};

template <typename Names, typename Value>
std::string name_in(const Names& names, Value value) {
  for (const auto& [known, name] : names) {
    if (known == value) return name;
  }
  return "";
}

template <typename Names>
auto choose(const Names& names, StrictTable& table, const std::string& key,
            const std::string& fallback) {
  const std::string text = table.text(key, fallback);
  std::string list;
  for (const auto& [value, name] : names) {
    if (name == text) return value;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  throw InvalidArgument("'" + text + "' is not known", table.place(key), "one of " + list);
}

template <typename Candidates>
std::vector<FitParameter> parameters(const Candidates& candidates, StrictTable& table,
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

std::vector<FitShot> shots(StrictTable& root, const std::string& key,
                           const std::filesystem::path& folder, double angle_deg) {
  std::vector<FitShot> list;
  for (const std::string& text : root.texts(key)) {
    list.push_back({std::filesystem::absolute(folder / text).lexically_normal(), angle_deg});
  }
  return list;
}

void positive(StrictTable& table, const std::string& key, double value) {
  if (!(value > 0)) throw InvalidArgument("must be positive", table.place(key));
}

// The tables that both kinds of job share; `root` is not finished.
FitJob read_common(StrictTable& root) {
  FitJob job;
  root.text("normal");  // a forgotten line must not choose a law
  root.text("friction");
  job.impact = read_impact_tables(root, true);
  StrictTable& body = root.table("body");
  positive(body, "mass_kg", body.number("mass_kg"));
  positive(body, "diameter_m", body.number("diameter_m"));
  StrictTable& fit = root.table("fit");
  job.method = choose(kMethods, fit, "method", "trajectory");
  job.parameters = parameters(kLawParameters, fit, "parameters", job.impact.normal);
  if (fit.has("unknowns")) {
    job.unknowns = parameters(kShotUnknowns, fit, "unknowns", job.impact.normal);
  }
  job.flight_frames = fit.integer("flight_frames", job.flight_frames);
  if (job.flight_frames < 8) {
    throw InvalidArgument("must be at least 8", fit.place("flight_frames"));
  }
  job.outlier_sd = fit.number("outlier_sd", job.outlier_sd);
  positive(fit, "outlier_sd", job.outlier_sd);
  StrictTable& grid = root.table("grid");
  job.grid.stiffness_max = grid.number("stiffness_max", job.grid.stiffness_max);
  job.grid.damping_max_n_s_per_m =
      grid.number("damping_max_n_s_per_m", job.grid.damping_max_n_s_per_m);
  job.grid.stiffness_steps = grid.integer("stiffness_steps", job.grid.stiffness_steps);
  job.grid.damping_steps = grid.integer("damping_steps", job.grid.damping_steps);
  positive(grid, "stiffness_max", job.grid.stiffness_max);
  positive(grid, "damping_max_n_s_per_m", job.grid.damping_max_n_s_per_m);
  for (const auto& [key, steps] : {std::pair{"stiffness_steps", job.grid.stiffness_steps},
                                   std::pair{"damping_steps", job.grid.damping_steps}}) {
    if (steps < 5 || steps > 1000) {
      throw InvalidArgument("must be from 5 to 1000", grid.place(key));
    }
  }
  return job;
}

// What is not fitted must be given, and be possible.
void validate(StrictTable& root, const FitJob& job) {
  ImpactJob probe = job.impact;
  probe.initial.vn_m_s = -1;
  for (FitParameter p : job.parameters) {
    if (law_parameter(probe, p) == 0)
      set_law_parameter(probe, p, p == FitParameter::kPoisson ? 0.3 : 1);
  }
  if (job.method != FitMethod::kTrajectory) {
    probe.contact.stiffness = probe.contact.damping_n_s_per_m = 1;
  }
  probe.contact.friction_static =
      std::max(probe.contact.friction_static, probe.contact.friction_kinetic);
  try {
    probe.validate();
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), root.place(error.where()), error.hint());
  }
}

double surface_angle(StrictTable& root) {
  StrictTable& surface = root.table("surface");
  return surface.has("angle_deg") ? surface.number("angle_deg") : kNotMeasured;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string list(const std::vector<std::string>& texts) {
  std::string out = "[";
  for (const std::string& text : texts) out += (out.size() > 1 ? ", " : "") + quoted(text);
  return out + "]";
}

std::vector<std::string> paths(const std::vector<FitShot>& shots) {
  std::vector<std::string> out;
  for (const FitShot& shot : shots) out.push_back(shot.track.string());
  return out;
}

// Everything after the lists of tracks.
std::string tables(const FitJob& job, double angle_deg) {
  const ImpactJob& i = job.impact;
  std::string out;
  const auto number = [&out](const std::string& key, double value) {
    if (!std::isnan(value)) out += key + " = " + shortest(value) + "\n";
  };
  const auto text = [&out](const std::string& key, std::string_view value) {
    out += key + " = " + quoted(std::string(value)) + "\n";
  };
  const auto keys = [&](const std::vector<FitParameter>& chosen) {
    std::vector<std::string> names;
    for (FitParameter p : chosen) names.push_back(key_of(p, i.normal));
    return list(names);
  };
  out += "\n[body]\n";
  text("shape", name_of(i.body.shape));
  number("mass_kg", i.body.mass_kg);
  number("diameter_m", i.body.diameter_m);
  if (i.body.inertia_kg_m2 > 0) number("inertia_kg_m2", i.body.inertia_kg_m2);
  out += "\n[contact]\n";
  if (i.normal == NormalModel::kLinearSpringDamper || i.normal == NormalModel::kHertzDamper) {
    number(key_of(FitParameter::kStiffness, i.normal), i.contact.stiffness);
    number("damping_n_s_per_m", i.contact.damping_n_s_per_m);
    text("restitution_damping", name_of(i.contact.restitution_damping));
    if (i.friction == FrictionModel::kMawBarberFawcett) number("poisson", i.contact.poisson);
  } else {
    number("reduced_modulus_pa", i.contact.reduced_modulus_pa);
    number("yield_strength_pa", i.contact.yield_strength_pa);
    number("poisson", i.contact.poisson);
    text("residual", name_of(i.contact.residual));
  }
  if (i.friction != FrictionModel::kNone) number("friction_kinetic", i.contact.friction_kinetic);
  if (i.friction == FrictionModel::kThreePhase)
    number("friction_static", i.contact.friction_static);
  if (!std::isnan(angle_deg)) {
    out += "\n[surface]\n";
    number("angle_deg", angle_deg);
  }
  out += "\n[environment]\n";
  number("gravity_m_s2", i.gravity_m_s2);
  out += "\n[solver]\n";
  number("relative_tolerance", i.solver.relative_tolerance);
  out += "\n[fit]\n";
  text("method", name_in(kMethods, job.method));
  out += "parameters = " + keys(job.parameters) + "\nunknowns = " + keys(job.unknowns) + "\n";
  number("flight_frames", job.flight_frames);
  number("outlier_sd", job.outlier_sd);
  out += "\n[grid]\n";
  number("stiffness_max", job.grid.stiffness_max);
  number("damping_max_n_s_per_m", job.grid.damping_max_n_s_per_m);
  number("stiffness_steps", job.grid.stiffness_steps);
  number("damping_steps", job.grid.damping_steps);
  return out;
}

std::string laws(const ImpactJob& i) {
  return "normal = " + quoted(std::string(name_of(i.normal))) +
         "\nfriction = " + quoted(std::string(name_of(i.friction))) +
         "\npreset = " + quoted(std::string(name_of(i.preset))) + "\n";
}

}  // namespace

FitJob read_fit_job(const std::filesystem::path& file) {
  StrictTable root(file);
  FitJob job = read_common(root);
  job.shots = shots(root, "tracks", file.parent_path(), surface_angle(root));
  if (job.shots.empty()) throw InvalidArgument("no tracks are named", root.place("tracks"));
  if (job.parameters.empty() && job.method == FitMethod::kTrajectory) {
    throw InvalidArgument("no parameters are named", root.table("fit").place("parameters"));
  }
  root.finish();
  validate(root, job);
  return job;
}

CompareJob read_compare_job(const std::filesystem::path& file) {
  StrictTable root(file);
  CompareJob job;
  job.calibration = read_common(root);
  const double angle = surface_angle(root);
  job.shots = shots(root, "tracks", file.parent_path(), angle);
  if (job.shots.empty()) throw InvalidArgument("no tracks are named", root.place("tracks"));
  job.calibration.shots = shots(root, "calibrate_on", file.parent_path(), angle);
  if (!job.calibration.shots.empty() && job.calibration.parameters.empty() &&
      job.calibration.method == FitMethod::kTrajectory) {
    throw InvalidArgument("no parameters are named", root.table("fit").place("parameters"));
  }
  for (const std::string& name : root.texts("models")) {
    try {
      job.models.push_back(parse_friction_model(name));
    } catch (const InvalidArgument& error) {
      throw InvalidArgument(error.what(), root.place("models"), error.hint());
    }
  }
  if (job.models.empty()) job.models.push_back(job.calibration.impact.friction);
  job.friction_source = choose(kFrictionSources, root, "friction_source", "job");
  root.finish();
  FitJob probe = job.calibration;
  if (probe.shots.empty()) probe.parameters.clear(), probe.method = FitMethod::kTrajectory;
  validate(root, probe);
  return job;
}

std::string to_toml(const FitJob& job) {
  return laws(job.impact) + "tracks = " + list(paths(job.shots)) + "\n" +
         tables(job, job.shots.empty() ? kNotMeasured : job.shots[0].surface_angle_deg);
}

std::string to_toml(const CompareJob& job) {
  std::vector<std::string> models;
  for (FrictionModel model : job.models) models.emplace_back(name_of(model));
  std::string out = laws(job.calibration.impact) + "tracks = " + list(paths(job.shots)) + "\n";
  if (!job.calibration.shots.empty()) {
    out += "calibrate_on = " + list(paths(job.calibration.shots)) + "\n";
  }
  out += "models = " + list(models) +
         "\nfriction_source = " + quoted(name_in(kFrictionSources, job.friction_source)) + "\n";
  return out + tables(job.calibration, job.shots[0].surface_angle_deg);
}

}  // namespace impactdic
