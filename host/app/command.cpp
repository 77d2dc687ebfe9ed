#include "host/app/command.h"

#include <impactdic/safety/sandbox.h>

#include <memory>
#include <vector>

#include "host/app/job.h"
#include "host/run/folder.h"

namespace impactdic::app {

void add_common_options(CLI::App& command, Common& common) {
  command
      .add_option("--device", common.session.device,
                  "OpenCL device: auto, cpu, gpu, an index, a name, or all (track: every "
                  "GPU, else every CPU)")
      ->capture_default_str();
  command.add_option("-j,--threads", common.session.threads, "Host threads; 0 takes all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.add_flag("-q,--quiet", common.quiet, "Print errors only");
  command.add_flag("-v,--verbose", common.verbosity,
                   "Say more: times of every kernel and stage; -vv for debugging");
  command.add_flag("--force", common.force, "Write into a folder that already holds files");
  command.add_option_function<std::string>(
      "--job", [&command](const std::string& file) { apply_job(command, file); },
      "TOML file with any of these options under their long names; those on the command line win");
}

void add_sandbox_option(CLI::App& command) {
  CLI::Option* off = command.add_flag_callback(
      "--no-sandbox", [] { set_sandbox(false); },
      "Decode AVI, MP4, MOV and MKV in this program, not in a process of their own");
  command
      .add_flag_callback(
          "--sandbox", [] { set_picture_sandbox(true); },
          "Decode pictures (PNG, JPEG, BMP, PGM, TIFF) in a process of their own, too")
      ->excludes(off);
}

std::filesystem::path prepare_output_directory(const std::string& dir, bool force) {
  static std::vector<std::unique_ptr<run::OutputFolder>> held;  // until the program ends
  return held.emplace_back(std::make_unique<run::OutputFolder>(dir, force))->path();
}

}  // namespace impactdic::app
