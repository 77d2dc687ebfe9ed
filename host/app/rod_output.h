// What `impactdic rod` writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/rod/markers.h"
#include "sim/rod/rod_motion.h"

namespace impactdic::app {

// A rod model's rebound from the measured motion before the blow.
struct RodPrediction {
  std::string model;
  sim::rod::RodImpact impact;
};

// A row of a permanent-deformation table beside what the models leave.
struct DeformationComparison {
  sim::rod::DeformationRow measured;
  double rigid_m = 0, flexible_m = 0;
};

// motion.csv, one row a frame: time_s,status,qt_m,qn_m,out_of_plane_m,angle_12_deg,angle_13_deg,
// angle_23_deg,angle_deg,vt_m_s,vn_m_s,omega_rad_s. Each throws FileError.
void write_rod_motion(const std::filesystem::path& file,
                      const sim::rod::RodMeasurement& measurement);
void write_rod_summary(const std::filesystem::path& file, const std::string& input,
                       const sim::rod::RodMeasureOptions& options,
                       const sim::rod::RodMeasurement& measurement,
                       const std::vector<RodPrediction>& predictions);
// deformation.csv: angle_deg,speed_m_s,depth_m,depth_sd_m,rigid_rod_m,flexible_rod_m.
void write_deformations(const std::filesystem::path& file,
                        const std::vector<DeformationComparison>& rows);

}  // namespace impactdic::app
