// impactdic compare JOB.toml -o DIR: models against measured tracks or tables of shots.
#include <impactdic/compare.h>

#include <cmath>
#include <cstdio>

#include "host/app/job_command.h"
#include "host/report/job/compare_files.h"
#include "sim/compare/compare_job.h"
#include "sim/compare/rod_comparison.h"

namespace impactdic::app {
namespace {

// A number, or as much room where there is none.
std::string cell(const char* format, double value, int width) {
  char text[32];
  if (std::isnan(value)) return std::string(static_cast<std::size_t>(width - 1), ' ') + "-";
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void print(const CompareResult& result) {
  const auto line = [](const char* name, double vt, double vn, double omega) {
    std::printf("  %-20s vt %s  vn %s m/s  omega %s rad/s", name, cell("%8.4f", vt, 8).c_str(),
                cell("%8.4f", vn, 8).c_str(), cell("%8.3f", omega, 8).c_str());
  };
  for (const ComparedShot& c : result.shots) {
    const ShotFlight& after = c.shot.after;
    std::printf("%s, %.1f deg\n", c.shot.file.c_str(), c.shot.surface_angle_deg);
    line("measured", after.vt_m_s.value, after.vn_m_s.value, after.omega_rad_s.value);
    std::printf("\n");
    for (const ModelOutcome& m : c.models) {
      const ModelPrediction& p = m.prediction;
      line(std::string(name_of(m.model)).c_str(), p.vt_m_s, p.vn_m_s, p.omega_rad_s);
      if (!std::isnan(m.rms_m)) std::printf("  rms %.4f mm", 1e3 * m.rms_m);
      std::printf("\n");
      if (!std::isnan(m.printed.vt_m_s) || !std::isnan(m.printed.omega_rad_s)) {
        line("  printed", m.printed.vt_m_s, m.printed.vn_m_s, m.printed.omega_rad_s);
        std::printf("\n");
      }
    }
  }
}

void print(const RodCompareResult& result) {
  for (const ComparedBlow& blow : result.blows) {
    std::printf("%s, rod at %.1f deg\n  %-14s e %s  omega %s rad/s\n", blow.file.c_str(),
                blow.rod_angle_deg, "measured", cell("%7.4f", blow.restitution, 7).c_str(),
                cell("%8.3f", blow.after.omega_rad_s.value, 8).c_str());
    for (const RodOutcome& m : blow.models) {
      std::printf("  %-14s e %7.4f  omega %8.3f rad/s", m.model.c_str(), m.restitution,
                  m.omega_rad_s);
      if (m.micro_impacts > 0) {
        std::printf("  micro-impacts %d  dent %.2f um", m.micro_impacts, 1e6 * m.residual_m);
      }
      std::printf("\n");
    }
  }
}

void run_compare(const JobOptions& options) {
  if (sim::compare::is_rod_compare_job(options.job)) {
    run_job<RodCompareRequest, RodCompareResult>(
        options, {sim::compare::read_rod_compare_job, compare, report::write_rod_comparison,
                  sim::compare::to_toml, print});
    return;
  }
  run_job<CompareRequest, CompareResult>(
      options, {sim::compare::read_compare_job, compare, report::write_comparison,
                sim::compare::to_toml, print});
}

}  // namespace

void add_compare_command(CLI::App& app) {
  add_job_command(app,
                  {.name = "compare",
                   .description = "Models against measured tracks or tables of shots",
                   .job_help = "The job, a TOML file (docs/calibration.md)",
                   .footer = "Writes summary.json, comparison.csv, phases.csv, restitution.csv,\n"
                             "restitution_by_angle.csv, job.toml; of a rod summary.json, "
                             "comparison.csv, job.toml.\n"
                             "Example:\n  impactdic compare sim/jobs/compare_racket.toml -o racket",
                   .threads = true},
                  run_compare);
}

}  // namespace impactdic::app
