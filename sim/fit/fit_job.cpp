#include "sim/fit/fit_job.h"

#include <impactdic/units.h>

#include "sim/fit/fit_tables.h"

namespace impactdic::sim::fit {

FitRequest read_fit_job(const std::filesystem::path& file) {
  job::StrictTable root(file);
  FitRequest job = read_fit_tables(root, true);
  job.shots = shots_at(read_paths(root, "tracks", file.parent_path()), surface_angle(root));
  root.finish();
  job::validate_in_file(job, root);
  return job;
}

std::string to_toml(const FitRequest& job) {
  job::TomlText text;
  write_laws(text, job.impact);
  write_tracks(text, "tracks", job.shots);
  write_fit_tables(text, job, job.shots.empty() ? kNotMeasured : job.shots[0].surface_angle_deg);
  return text.str();
}

}  // namespace impactdic::sim::fit
