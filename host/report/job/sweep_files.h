// What `impactdic simulate` writes of a sweep.
#pragma once

#include <impactdic/models/sweep.h>

#include <filesystem>
#include <string>
#include <vector>

namespace impactdic::report {

// sweep.csv, one row a shot: the swept values, status (ok, held, failed), the motion before and
// after, restitutions, friction, contact, energy, tangential phases, reason. summary.json: the
// axes, the shots by status, the warnings. Each throws FileError.
void write_sweep(const std::filesystem::path& folder, const SweepRequest& request,
                 const SweepResult& result);

// How many shots, and how many of them have no motion after; for a terminal.
std::string sweep_words(const SweepResult& result);
// Each text once, with the number of shots that it is about.
std::vector<std::string> sweep_warnings(const SweepResult& result);

}  // namespace impactdic::report
