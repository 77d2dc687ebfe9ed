// Rod jobs in TOML files: what `impactdic simulate` does for `model = "rigid_rod"` or
// "flexible_rod".
#pragma once

#include <impactdic/rod_model.h>

#include <filesystem>
#include <string>

namespace impactdic::sim::job {
class StrictTable;
class TomlText;
}  // namespace impactdic::sim::job

namespace impactdic::sim::rod {

// The preset, the normal law and the tables body, contact, environment and solver of a job; neither
// finished nor validated.
RodModel read_rod_tables(job::StrictTable& root, bool flexible);
// The same but for the preset.
void write_rod_tables(job::TomlText& text, const RodModel& job, bool with_residual);

// Throws FileError, FormatError, or InvalidArgument naming file and key.
RodModel read_rod_job(const std::filesystem::path& file);
// The same of a file that holds more; neither finished nor validated.
RodModel read_rod_model(job::StrictTable& root);
// With every default spelled out; reads back to the same job.
std::string to_toml(const RodModel& job);

// trajectory.csv: the columns of the other models' trajectories, then compression_m and the contact
// point's velocities. Throws FileError.
void write_rod_trajectory(const std::filesystem::path& file, const RodImpact& impact);
// summary.json of `simulate`.
std::string rod_summary_json(const RodModel& job, const RodImpact& impact);

}  // namespace impactdic::sim::rod
