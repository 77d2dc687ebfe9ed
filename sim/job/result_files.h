// The files that `simulate` writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/contact/impact.h"

namespace impactdic::sim::job {

// One row a point, numbers in the shortest form that reads back exactly. Columns:
// time_s,qt_m,qn_m,angle_rad,vt_m_s,vn_m_s,omega_rad_s,normal_force_n,tangential_force_n,
// deflection_m,tip_vt_m_s and the energies of EnergyLedger, joules. A job that leaves the plane of
// t and n adds what moves along b, the spins and the orientation; one of two balls the other's
// motion. Throws FileError.
void write_trajectory_csv(const std::filesystem::path& file, const ImpactJob& job,
                          const std::vector<TrajectoryPoint>& trajectory);

// derivatives.csv: one row an outcome, one column an input after `outcome`; what does not exist is
// an empty field. Throws FileError.
void write_derivatives_csv(const std::filesystem::path& file, const ImpactDerivatives& derivatives);

// The result as JSON text: restitution, contact_s, t_max_compression_s, max_deflection_m,
// max_force_n, final, phases, energy, warnings and more. What does not exist is null.
std::string summary_json(const ImpactJob& job, const ImpactResult& result);

// Throws FileError.
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace impactdic::sim::job
