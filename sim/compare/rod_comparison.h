// Rod models against a table of measured blows (source chapter 5).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/rod/rod_job.h"
#include "sim/shot/shot_table.h"

namespace impactdic::sim::compare {

struct RodCompareJob {
  std::vector<std::filesystem::path> tables;  // shot_table.h, with rod_angle_deg
  std::filesystem::path printed;              // may be empty
  std::vector<std::string> models;            // rigid_rod, flexible_rod, stronge
  double energetic_restitution = 0;           // of stronge; NaN without it
  rod::RodJobFile rigid, flexible;            // motions of the blows are filled in
};

struct RodOutcome {
  std::string model;
  double restitution = 0;  // at the contact point
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
  int micro_impacts = 0;                                     // 0: a formula
  double start_to_end_s = 0, contact_s = 0, residual_m = 0;  // NaN of a formula
  shot::PrintedRow printed;
};

struct ComparedBlow {
  std::string file;  // "FILE: NAME"
  double rod_angle_deg = 0;
  shot::Flight before, after;
  double restitution = 0;  // measured at the contact point; NaN without
  std::vector<RodOutcome> models;
};

// Whether the file is a compare job of a rod (body.shape = "rod"). Throws FileError, FormatError.
bool is_rod_compare_job(const std::filesystem::path& file);
// Throws FileError, FormatError, or InvalidArgument naming file and key.
RodCompareJob read_rod_compare_job(const std::filesystem::path& file);
std::string to_toml(const RodCompareJob& job);

std::vector<ComparedBlow> compare_rods(const RodCompareJob& job, int threads);

}  // namespace impactdic::sim::compare
