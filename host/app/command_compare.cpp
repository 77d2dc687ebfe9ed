// impactdic compare JOB.toml -o DIR: models against measured tracks.
#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/fit_output.h"
#include "sim/fit/fit_job.h"
#include "sim/impact/result_files.h"

namespace impactdic::app {
namespace {

struct Options {
  std::string job, output;
  int threads = 0;
  bool force = false, quiet = false;
};

void print(const CompareResult& result) {
  for (const ComparedShot& c : result.shots) {
    std::printf("%s, %.1f deg\n  %-20s vt %8.4f  vn %8.4f m/s  omega %8.3f rad/s\n",
                c.shot.file.c_str(), c.shot.surface_angle_deg, "measured",
                c.shot.after.vt_m_s.value, c.shot.after.vn_m_s.value,
                c.shot.after.omega_rad_s.value);
    for (const ModelOutcome& m : c.models) {
      std::printf("  %-20s vt %8.4f  vn %8.4f m/s  omega %8.3f rad/s  rms %.4f mm\n",
                  std::string(name_of(m.model)).c_str(), m.vt_m_s, m.vn_m_s, m.omega_rad_s,
                  1e3 * m.rms_m);
    }
  }
}

void run_compare(const Options& options) {
  const CompareJob job = read_compare_job(options.job);
  const CompareResult result = compare(job, options.threads);
  const auto folder = prepare_output_directory(options.output, options.force);
  write_comparison(folder, job, result);
  write_text(folder / "job.toml", to_toml(job));
  if (!options.quiet) print(result);
}

}  // namespace

void add_compare_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("compare", "Models against measured tracks");
  auto options = std::make_shared<Options>();
  command->add_option("JOB", options->job, "The job, a TOML file (docs/calibration.md)")
      ->required();
  command->add_option("-o,--output", options->output, "Folder for the results")->required();
  command->add_option("-j,--threads", options->threads, "Shots at a time; 0 takes all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--force", options->force, "Write into a folder that already holds files");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes summary.json, comparison.csv, restitution.csv, restitution_by_angle.csv, job.toml.\n"
      "Example:\n  impactdic compare wooden_flat.toml -o wooden_flat");
  command->callback([options] { run_compare(*options); });
}

}  // namespace impactdic::app
