#include "host/app/command.h"

#include <system_error>

#include "host/base/error.h"

namespace impactdic::app {

void add_common_options(CLI::App& command, Common& common) {
  command
      .add_option("--device", common.device, "OpenCL device: auto, cpu, gpu, an index, a name, or all (track: every "
                  "GPU, else every CPU)")
      ->capture_default_str();
  command.add_option("-j,--threads", common.threads, "Host threads; 0 takes all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.add_flag("-q,--quiet", common.quiet, "Print errors only");
  command.add_flag("-v,--verbose", common.verbosity,
                   "Say more: times of every kernel and stage; -vv for debugging");
  command.add_flag("--force", common.force, "Write into a folder that already holds files");
  command.add_option("--job", common.job_file,
                     "TOML file with any of these options under their long names; those on the "
                     "command line win");
}

std::filesystem::path prepare_output_directory(const std::string& dir, bool force) {
  namespace fs = std::filesystem;
  const fs::path path(dir);
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error)) {
    throw InvalidArgument("the output must be a folder", dir);
  }
  if (fs::is_directory(path, error) && !fs::is_empty(path, error) && !force) {
    throw InvalidArgument("the output folder is not empty", dir, "--force writes into it");
  }
  fs::create_directories(path, error);
  if (error) throw FileError("cannot make the folder: " + error.message(), dir);
  return path;
}

}  // namespace impactdic::app
