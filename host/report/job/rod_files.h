// What `impactdic rod` writes.
#pragma once

#include <impactdic/rod.h>

#include <filesystem>

namespace impactdic::report {

// motion.csv, one row a frame: time_s,status,qt_m,qn_m,out_of_plane_m,angle_12_deg,angle_13_deg,
// angle_23_deg,angle_deg,vt_m_s,vn_m_s,omega_rad_s; summary.json; deformation.csv where there are
// any: angle_deg,speed_m_s,depth_m,depth_sd_m,rigid_rod_m,flexible_rod_m. Throws FileError.
void write_rod(const std::filesystem::path& folder, const RodRequest& request,
               const RodResult& result);

}  // namespace impactdic::report
