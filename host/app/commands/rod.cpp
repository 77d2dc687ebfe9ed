// impactdic rod MARKERS.csv -o DIR: a rod's impact from three markers (chapter 5).
#include <impactdic/rod.h>

#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/job_command.h"
#include "host/report/job/rod_files.h"
#include "host/report/words/model_words.h"
#include "sim/rod/markers.h"

namespace impactdic::app {
namespace {

struct RodArguments {
  Common common;
  std::string markers, output, vertical = "y", deformations;
  RodRequest rod;
};

void run_rod(const CLI::App& command, const RodArguments& options) {
  RodRequest request = options.rod;
  request.measure.vertical_down = options.vertical.size() == 2;
  request.measure.vertical_axis = static_cast<std::size_t>(options.vertical.back() - 'x');
  request.threads = options.common.session.threads;
  request.markers = sim::rod::read_markers(options.markers);
  if (!options.deformations.empty()) {
    request.deformations = sim::rod::read_deformations(options.deformations);
  }
  const RodResult result = measure_rod(request);
  const auto folder = prepare_output_directory(options.output, options.common.force);
  report::write_rod(folder, request, result);
  write_job(command, folder / "job.toml");
  if (!options.common.quiet) std::fputs(report::in_words(result).c_str(), stdout);
  print_warnings(result.measurement.warnings);
}

void add_rod_options(CLI::App& command, RodArguments& r) {
  RodMeasureOptions& measure = r.rod.measure;
  RodBody& body = measure.body;
  const auto number = [&](const char* name, double& value, const char* text) {
    command.add_option(name, value, text)->capture_default_str();
  };
  command.add_option("MARKERS", r.markers, "Table time_s,x1_m,y1_m,z1_m,x2_m,...,z3_m")->required();
  command.add_option("-o,--output", r.output, "Folder for the results")->required();
  command.add_option("--vertical", r.vertical, "Which axis of the table points up: x y z -x -y -z")
      ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}))
      ->capture_default_str();
  number("--length-m", body.length_m, "Length of the rod");
  number("--radius-m", body.radius_m, "Radius of the rod and of its round end");
  number("--mass-kg", body.mass_kg, "Mass of the rod");
  number("--centre-offset-m", measure.centre_offset_m,
         "Centre of mass from marker 2, towards marker 3");
  number("--friction", measure.friction_kinetic, "Coefficient of friction");
  number("--young-pa", body.young_pa, "Young's modulus of the rod");
  number("--flat-young-pa", r.rod.flat_young_pa, "Young's modulus of the flat");
  number("--poisson", r.rod.poisson, "Poisson's ratio of both");
  number("--yield-strength-pa", r.rod.yield_strength_pa, "Yield strength of the weaker");
  number("--modal-damping", r.rod.modal_damping, "Fraction of critical, every mode");
  number("--gravity-m-s2", measure.gravity_m_s2, "Gravity of the place");
  command.add_option("--deformations", r.deformations,
                     "Permanent-deformation table angle_deg,speed_m_s,depth_m[,depth_sd_m]");
  add_common_options(command, r.common);
}

}  // namespace

void add_rod_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("rod", "Impact of a rod from three markers");
  auto options = std::make_shared<RodArguments>();
  add_rod_options(*command, *options);
  command->footer(
      "Marker 1 sits near the struck end, 2 at the centre of mass, 3 near the upper end; a marker\n"
      "out of sight is left empty. The defaults are the steel rod of the dissertation, chapter 5.\n"
      "Writes motion.csv, summary.json, job.toml (and deformation.csv).\n"
      "Example:\n  impactdic rod drop_45.csv -o drop_45 --vertical z");
  command->callback([command, options] { run_rod(*command, *options); });
}

}  // namespace impactdic::app
