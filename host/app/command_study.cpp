#include <impactdic/error.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/run_context.h"
#include "host/app/terminal_progress.h"
#include "host/base/parse.h"
#include "host/report/summary.h"
#include "host/study/density_study.h"
#include "host/study/pattern_report.h"

namespace impactdic::app {
namespace {

struct Request {
  Common common;
  std::string what, output, patterns, estimators;
  study::PatternStudyOptions options;
  study::DensityStudyOptions density;
};

std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> items;
  for (const std::string& item : split(text, ',')) {
    if (!trim(item).empty()) items.push_back(trim(item));
  }
  return items;
}

// Where the results are, and how they become figures.
void print_figures(const std::filesystem::path& folder, const char* table, std::size_t rows,
                   const char* figures) {
  std::printf("%zu rows in %s; python3 scripts/study_figures.py %s draws figures %s\n", rows,
              (folder / table).c_str(), folder.c_str(), figures);
}

void study_patterns(const CLI::App& command, Request request) {
  study::PatternStudyOptions& options = request.options;
  options.patterns = list_of(request.patterns);
  if (!request.estimators.empty()) options.estimators = list_of(request.estimators);
  options.validate();
  RunContext run(request.common);
  const auto folder = prepare_output_directory(request.output, request.common.force);
  write_job(command, folder / "job.toml");
  const Stopwatch watch;
  std::vector<study::PatternStudyRow> rows;
  {
    TerminalProgress progress("study", request.common.quiet);
    rows = study::run_pattern_study(run.engine(), options, std::ref(progress));
  }
  study::write_pattern_csv(folder / "patterns.csv", rows);
  nlohmann::json summary = study::describe_patterns(rows, options);
  summary["device"] = run.describe();
  summary["seconds"] = watch.seconds();
  report::write_json(folder / "summary.json", summary);
  if (!request.common.quiet) {
    std::printf("%s\n", summary["finding"].get<std::string>().c_str());
    print_figures(folder, "patterns.csv", rows.size(), "2.4 to 2.7");
  }
  run.print_profile();
}

void study_density(const CLI::App& command, Request request) {
  study::DensityStudyOptions& options = request.density;
  const std::vector<std::string> patterns = list_of(request.patterns);
  if (patterns.size() > 1) {
    throw InvalidArgument("the density study takes one pattern", "--patterns");
  }
  if (!patterns.empty()) options.pattern = patterns.front();
  options.noise = request.options.noise;
  options.seed = request.options.seed;
  options.radius_px = request.options.radius_px;
  options.validate();
  RunContext run(request.common);
  const auto folder = prepare_output_directory(request.output, request.common.force);
  write_job(command, folder / "job.toml");
  study::DensityStudy study;
  {
    TerminalProgress progress("study", request.common.quiet);
    study = study::run_density_study(run.engine(), options, std::ref(progress));
  }
  study::write_density_csv(folder / "density.csv", study.rows);
  study::write_window_csv(folder / "window.csv", study.window, 1);
  const double fine = static_cast<double>(study.window.width() - 1) /
                      static_cast<double>(study.interpolated.width() - 1);
  study::write_window_csv(folder / "window_spline.csv", study.interpolated, fine);
  nlohmann::json summary = study::describe_density(study.rows, options.window_px);
  summary["device"] = run.describe();
  report::write_json(folder / "summary.json", summary);
  if (!request.common.quiet) {
    std::printf("%s\n", summary["finding"].get<std::string>().c_str());
    print_figures(folder, "density.csv", study.rows.size(), "2.1 and 2.2");
  }
  run.print_profile();
}

void run_study(const CLI::App& command, const Request& request) {
  if (request.what == "patterns") return study_patterns(command, request);
  if (request.what == "density") return study_density(command, request);
  throw InvalidArgument("there is no study '" + request.what + "'", "study", "patterns, density");
}

}  // namespace

void add_study_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "study", "The speckle study: which pattern to paint, which method to take");
  auto request = std::make_shared<Request>();
  study::PatternStudyOptions& options = request->options;
  command->add_option("what", request->what, "patterns or density")->required();
  command->add_option("-o,--output", request->output, "Folder for the results")->required();
  command->add_option("--patterns", request->patterns,
                      "patterns: which, as a1,e1,f2; without it, all sixteen");
  command->add_option("--estimators", request->estimators,
                      "patterns: which of published (or published0 … published9), zncc, icgn3, "
                      "icgn5, icgn7, ring, ball; without it, all with published at 5 points");
  command->add_option("--noise", options.noise, "Camera noise, grey levels of 255")
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Of the patterns and of the noise")
      ->capture_default_str();
  command->add_option("--radius-px", options.radius_px, "The ball's radius, px")
      ->capture_default_str();
  command->add_option("--pairs", options.pairs, "patterns: pairs of frames for each motion")
      ->capture_default_str();
  study::DensityStudyOptions& density = request->density;
  command->add_option("--windows", density.windows, "density: windows measured")
      ->capture_default_str();
  command
      ->add_option("--interp", density.most_points,
                   "density: up to how many spline points between pixels")
      ->capture_default_str();
  add_common_options(*command, request->common);
  command->footer(
      "patterns: balls painted as in the source times eight motions times estimators; writes "
      "patterns.csv and summary.json.\n"
      "density: time and error against the spline points between pixels; writes density.csv, "
      "window.csv, window_spline.csv and summary.json.\n"
      "Example:\n  impactdic study patterns -o study --estimators icgn5,ball\n");
  command->callback([command, request] { run_study(*command, *request); });
}

}  // namespace impactdic::app
