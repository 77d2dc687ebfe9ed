// Impact jobs in TOML files. Every key carries its unit; an unknown key is an error.
#pragma once

#include <filesystem>
#include <string>

#include "sim/impact/model.h"

namespace impactdic {

class StrictTable;

// A `simulate` job file: the impact and what to write of it.
struct SimulateJob {
  ImpactJob impact;
  double rate_hz = 0;  // rows of trajectory.csv per second; 0: 200 rows over the first contact
};

// Throws FileError, FormatError, or InvalidArgument naming file and key.
SimulateJob read_simulate_job(const std::filesystem::path& file);
// The job with every default spelled out; reads back to the same job.
std::string to_toml(const SimulateJob& job);

// For other kinds of job that contain an impact: the keys normal, friction, preset and the tables
// body, contact, surface, initial, environment, solver of `root`, each optional where `partial`
// (a fit finds them itself). Neither validated nor finished.
ImpactJob read_impact_tables(StrictTable& root, bool partial);

}  // namespace impactdic
