// Impact jobs in TOML files. Every key carries its unit; an unknown key is an error.
#pragma once

#include <impactdic/simulate.h>

#include <filesystem>
#include <string>

namespace impactdic::sim::job {

class StrictTable;
class TomlText;

// What the job's key `model` says: kelvin_voigt, garwin, cross, walton, stronge, rigid_rod,
// flexible_rod, or nothing where `normal` and `friction` choose the laws. Throws FileError,
// FormatError, or InvalidArgument for another name.
std::string model_of_job(const std::filesystem::path& file);

// Of laws that are integrated; `model = "kelvin_voigt"` (a spring and a damper that acts to the
// end, given by stiffness and damping or by restitution and contact_s) is one. Throws FileError,
// FormatError, or InvalidArgument naming file and key.
SimulateRequest read_simulate_job(const std::filesystem::path& file);
// The same of a file that holds more; neither finished nor validated.
SimulateRequest read_simulate_tables(StrictTable& root);
// The job with every default spelled out; reads back to the same job.
std::string to_toml(const SimulateRequest& job);

// For other kinds of job that contain an impact: the keys normal, friction, preset and the tables
// body, contact, surface, initial, environment, solver of `root`, each optional where `partial`
// (a fit finds them itself). Neither validated nor finished.
ImpactJob read_impact_tables(StrictTable& root, bool partial);
ImpactBody read_body(StrictTable& table, bool partial);
ModelPreset read_preset(StrictTable& root, ModelPreset fallback);
// The table [shell], where the ball is one.
void write_shell(TomlText& text, const ImpactJob& job);
// The table [air], where the air acts.
void write_air(TomlText& text, const AirForces& air);
// The table [contact].
void write_contact(TomlText& text, const ImpactJob& job);

}  // namespace impactdic::sim::job
