#include "sim/compare/rod_comparison.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/parallel/parallel_for.h"
#include "sim/contact/rebound.h"
#include "sim/fit/fit_tables.h"
#include "sim/rod/rod_impact.h"
#include "sim/rod/rod_job.h"
#include "sim/shot/shot_table.h"

namespace impactdic::sim::compare {
namespace {

constexpr const char* kRigid = "rigid_rod";
constexpr const char* kFlexible = "flexible_rod";
constexpr const char* kStronge = "stronge";

double known(double value) { return std::isnan(value) ? 0 : value; }

// Of the contact point, which lies half a length below the centre along the axis.
double tip_vn(double vn, double omega, double length, double angle_rad) {
  return vn - known(omega) * length / 2 * std::cos(angle_rad);
}

RodOutcome integrated(const std::string& model, RodJob rod, const shot::TableShot& row) {
  rod.angle_rad = row.rod_angle_deg * kRadPerDeg;
  rod.vt_m_s = row.shot.before.vt_m_s.value;
  rod.vn_m_s = row.shot.before.vn_m_s.value;
  rod.omega_rad_s = known(row.shot.before.omega_rad_s.value);
  const RodImpact impact = rod::simulate_rod(rod);
  return {model,
          impact.restitution,
          impact.vt_m_s,
          impact.vn_m_s,
          impact.omega_rad_s,
          impact.micro_impacts,
          impact.start_to_end_s,
          impact.contact_s,
          impact.residual_m,
          {}};
}

RodOutcome by_stronge(const RodCompareRequest& job, const shot::TableShot& row) {
  const RodJob& rod = job.rigid.rod;
  ReboundJob rebound;
  rebound.model = ReboundModel::kStronge;
  rebound.body = {BodyShape::kRod, rod.body.mass_kg, 2 * rod.body.radius_m, rod.body.length_m};
  rebound.restitution = job.energetic_restitution;
  rebound.friction_kinetic = rod.friction_kinetic;
  rebound.initial = {row.shot.before.vt_m_s.value, row.shot.before.vn_m_s.value,
                     known(row.shot.before.omega_rad_s.value), 0, row.rod_angle_deg};
  const ReboundResult result = contact::simulate_rebound(rebound);
  return {kStronge,
          result.restitution,
          result.after.vt_m_s,
          result.after.vn_m_s,
          result.after.omega_rad_s,
          0,
          kNotMeasured,
          kNotMeasured,
          kNotMeasured,
          {}};
}

ComparedBlow compare_blow(const RodCompareRequest& job, const std::vector<PrintedFigures>& printed,
                          const shot::TableShot& row) {
  const MeasuredShot& shot = row.shot;
  ComparedBlow blow{shot.file, row.rod_angle_deg, shot.before, shot.after, row.restitution, {}};
  const double length = job.rigid.rod.body.length_m, angle = row.rod_angle_deg * kRadPerDeg;
  const double after = tip_vn(shot.after.vn_m_s.value, shot.after.omega_rad_s.value, length, angle);
  const double before =
      tip_vn(shot.before.vn_m_s.value, shot.before.omega_rad_s.value, length, angle);
  if (std::isnan(blow.restitution)) blow.restitution = -after / before;
  for (const std::string& model : job.models) {
    RodOutcome outcome =
        model == kStronge
            ? by_stronge(job, row)
            : integrated(model, (model == kRigid ? job.rigid : job.flexible).rod, row);
    outcome.printed = shot::printed_for(printed, row.name, model);
    blow.models.push_back(outcome);
  }
  return blow;
}

}  // namespace

bool is_rod_compare_job(const std::filesystem::path& file) {
  job::StrictTable root(file);
  return root.table("body").text("shape", "") == "rod";
}

RodCompareRequest read_rod_compare_job(const std::filesystem::path& file) {
  job::StrictTable root(file);
  root.table("body").text("shape");
  RodCompareRequest job;
  job.models = root.texts("models");
  if (job.models.empty()) job.models = {kRigid, kFlexible};
  job.tables = fit::read_paths(root, "shots", file.parent_path());
  const std::string printed = root.text("printed", "");
  if (!printed.empty()) {
    job.printed = std::filesystem::absolute(file.parent_path() / printed).lexically_normal();
  }
  job.rigid = rod::read_rod_tables(root, false);
  const bool flexible =
      std::find(job.models.begin(), job.models.end(), kFlexible) != job.models.end();
  if (flexible) job.flexible = rod::read_rod_tables(root, true);
  job.energetic_restitution = kNotMeasured;
  if (std::find(job.models.begin(), job.models.end(), kStronge) != job.models.end()) {
    job.energetic_restitution = root.table("formula").number("restitution");
  }
  root.finish();
  job::validate_in_file(job, root);
  return job;
}

std::string to_toml(const RodCompareRequest& job) {
  job::TomlText text;
  std::vector<std::string> tables;
  for (const auto& table : job.tables) tables.push_back(table.string());
  text.names("shots", tables);
  if (!job.printed.empty()) text.name("printed", job.printed.string());
  text.names("models", job.models);
  // Where the two differ, the job named neither preset nor residual: each model has its own.
  const bool both = job.flexible.flexible;
  const bool alike = !both || job.rigid.rod.residual == job.flexible.rod.residual;
  if (alike) text.name("preset", name_of(job.rigid.preset));
  rod::write_rod_tables(text, both ? job.flexible : job.rigid, alike);
  if (!std::isnan(job.energetic_restitution)) {
    text.table("formula");
    text.number("restitution", job.energetic_restitution);
  }
  return text.str();
}

RodCompareResult compare_rods(const RodCompareRequest& request, const RunControl& control) {
  request.validate();
  std::vector<PrintedFigures> printed;
  if (!request.printed.empty()) printed = shot::read_printed(request.printed);
  std::vector<shot::TableShot> rows;
  const RodBody& rod = request.rigid.rod.body;
  const ImpactBody body{BodyShape::kRod, rod.mass_kg, 2 * rod.radius_m, rod.length_m};
  for (const auto& table : request.tables) {
    for (const shot::TableShot& row :
         shot::read_shot_table(table, body, request.rigid.rod.gravity_m_s2)) {
      if (!(row.rod_angle_deg > 0 && row.rod_angle_deg < 180)) {
        throw FormatError(row.shot.file + ", column rod_angle_deg", -1,
                          "must be between 0 and 180");
      }
      rows.push_back(row);
    }
  }
  RodCompareResult result;
  result.blows.resize(rows.size());
  const std::vector<char> done = parallel_pieces(
      rows.size(), request.threads, "compare", control,
      [&](std::size_t i) { result.blows[i] = compare_blow(request, printed, rows[i]); });
  result.cancelled = keep_done(done, result.blows);
  return result;
}

}  // namespace impactdic::sim::compare
