#include "sim/compare/compare_job.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/fit/fit_tables.h"

namespace impactdic::sim::compare {
namespace {

constexpr std::array<std::pair<FrictionSource, const char*>, 3> kFrictionSources{
    {{FrictionSource::kJob, "job"},
     {FrictionSource::kEffectivePublished, "effective_published"},
     {FrictionSource::kEffectiveSound, "effective_sound"}}};

bool has(const CompareRequest& job, const ComparedModel& model) {
  return std::find(job.models.begin(), job.models.end(), model) != job.models.end();
}

// Coefficients that a model of the list needs and the job's own friction does not.
void read_coefficients(job::StrictTable& root, CompareRequest& job) {
  ContactParameters& contact = job.calibration.impact.contact;
  job::StrictTable& table = root.table("contact");
  const bool given = job.friction_source == FrictionSource::kJob;
  const bool some_friction =
      std::any_of(job.models.begin(), job.models.end(), [](const ComparedModel& model) {
        return model != ComparedModel{FrictionModel::kNone} &&
               model != ComparedModel{KelvinVoigt{}};
      });
  if (some_friction && given) contact.friction_kinetic = table.number("friction_kinetic");
  if (has(job, FrictionModel::kThreePhase) && (given || table.has("friction_static"))) {
    contact.friction_static = table.number("friction_static");
  }
  if (has(job, FrictionModel::kMawBarberFawcett)) contact.poisson = table.number("poisson");
}

void read_formula(job::StrictTable& root, CompareRequest& job) {
  job::StrictTable& table = root.table("formula");
  if (table.has("restitution")) {
    job.formula.restitution = table.number("restitution");
  }
  if (has(job, ReboundModel::kCross) || table.has("tangential_restitution")) {
    job.formula.tangential_restitution = table.number("tangential_restitution");
  }
}

}  // namespace

CompareRequest read_compare_job(const std::filesystem::path& file) {
  job::StrictTable root(file);
  const std::filesystem::path folder = file.parent_path();
  CompareRequest job;
  job.calibration = fit::read_fit_tables(root, false);
  const double angle = fit::surface_angle(root);
  job.shots = fit::shots_at(fit::read_paths(root, "tracks", folder), angle);
  job.tables = fit::read_paths(root, "shots", folder);
  const std::string printed = root.text("printed", "");
  if (!printed.empty())
    job.printed = std::filesystem::absolute(folder / printed).lexically_normal();
  job.calibration.shots = fit::shots_at(fit::read_paths(root, "calibrate_on", folder), angle);
  for (const std::string& name : root.texts("models")) {
    try {
      job.models.push_back(parse_compared_model(name));
    } catch (const InvalidArgument& error) {
      throw InvalidArgument(error.what(), root.place("models"), error.hint());
    }
  }
  if (job.models.empty()) job.models.push_back(job.calibration.impact.friction);
  job.friction_source = fit::choose(kFrictionSources, root, "friction_source", "job");
  read_coefficients(root, job);
  read_formula(root, job);
  root.finish();
  job::validate_in_file(job, root);
  return job;
}

std::string to_toml(const CompareRequest& job) {
  job::TomlText text;
  const ImpactJob& laws = job.calibration.impact;
  fit::write_laws(text, laws);
  fit::write_tracks(text, "tracks", job.shots);
  std::vector<std::string> tables, models;
  for (const auto& table : job.tables) tables.push_back(table.string());
  if (!tables.empty()) text.names("shots", tables);
  if (!job.printed.empty()) text.name("printed", job.printed.string());
  fit::write_tracks(text, "calibrate_on", job.calibration.shots);
  for (const ComparedModel& model : job.models) models.emplace_back(name_of(model));
  text.names("models", models);
  text.name("friction_source", fit::name_in(kFrictionSources, job.friction_source));
  text.table("formula");
  if (!std::isnan(job.formula.restitution)) text.number("restitution", job.formula.restitution);
  text.number("tangential_restitution", job.formula.tangential_restitution);
  fit::write_fit_tables(text, job.calibration,
                        job.shots.empty() ? kNotMeasured : job.shots[0].surface_angle_deg);
  return text.str();
}

}  // namespace impactdic::sim::compare
