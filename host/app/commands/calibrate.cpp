// impactdic calibrate PICTURES -o camera.toml: a camera from pictures of a target or a ruler.
#include <impactdic/camera/calibrate.h>

#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/base/parse.h"
#include "host/report/words/clip_words.h"

namespace impactdic::app {
namespace {

struct CalibrateArguments {
  Common common;
  CalibrateRequest request;
  std::string output, target = "checkerboard", cells;
  std::vector<double> marks;
};

void run_calibrate(CalibrateArguments& options) {
  CalibrateRequest& request = options.request;
  request.target = parse_calibration_target(options.target);
  if (!options.cells.empty()) {
    const std::vector<double> cells = parse_doubles(options.cells, 'x', 2, "--cells");
    request.columns = static_cast<int>(cells[0]);
    request.rows = static_cast<int>(cells[1]);
  }
  for (std::size_t i = 0; i + 1 < options.marks.size(); i += 2) {
    request.marks.push_back({options.marks[i], options.marks[i + 1]});
  }
  Terminal terminal(options.common.quiet);
  const CalibrateResult found =
      calibrate_to_file(request, options.output, options.common.force, terminal.control());
  terminal.end();
  if (!options.common.quiet) std::fputs(report::in_words(found).c_str(), stdout);
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("calibrate", "A camera from pictures of a target or a ruler");
  auto options = std::make_shared<CalibrateArguments>();
  CalibrateRequest& request = options->request;
  command->add_option("PICTURES", request.pictures, "Files, folders, quoted globs or clips")
      ->required();
  command->add_option("-o,--output", options->output, "The camera: a file, camera.toml")
      ->required();
  command->add_option("--target", options->target, "checkerboard, charuco, dots or ruler")
      ->capture_default_str();
  command->add_option("--cells", options->cells,
                      "CxR: squares along a row and a column, black and white; of dots the dots");
  const auto number = [&](const char* name, double& value, const char* help) {
    return command->add_option(name, value, help)->capture_default_str();
  };
  number("--pitch-mm", request.pitch_mm,
         "Side of a square; from dot to dot; from tick to tick of a ruler, or between its --marks")
      ->required();
  number("--pitch-sd-mm", request.pitch_sd_mm, "Standard deviation of the pitch");
  number("--marker-mm", request.marker_mm, "Side of a ChArUco marker; 0: 3/4 of the pitch");
  number("--dot-mm", request.dot_mm, "Diameter of a dot; 0: a third of the pitch");
  command->add_option("--dictionary", request.dictionary, "Of ChArUco: 4x4_50 … 7x7_1000, original")
      ->capture_default_str();
  command->add_option("--plane", request.plane,
                      "The picture whose target lies in the plane of motion; without it the first");
  command
      ->add_option("--marks", options->marks,
                   "X1,Y1,X2,Y2: two marks of a ruler, px; without them its ticks are found")
      ->delimiter(',')
      ->expected(4);
  number("--marks-sd-px", request.marks_sd_px, "Standard deviation of a mark along an axis");
  add_common_options(*command, options->common);
  add_sandbox_option(*command);
  command->footer(
      "Writes camera.toml and, beside it, a drawing of the residuals (.svg).\n"
      "Example:\n  impactdic calibrate 'target/*.png' --cells 10x7 --pitch-mm 12 -o camera.toml\n");
  command->callback([options] { run_calibrate(*options); });
}

}  // namespace impactdic::app
