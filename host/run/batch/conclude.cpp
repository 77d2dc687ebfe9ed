#include "host/run/batch/conclude.h"

#include <impactdic/error.h>

#include <algorithm>
#include <system_error>

namespace impactdic::run {

namespace fs = std::filesystem;

void make_shots_folder(const ShotRunner& runner, const std::string& clips) {
  std::error_code error;
  fs::create_directories(runner.shots(), error);
  if (error) throw FileError("cannot make the folder: " + error.message(), runner.shots().string());
  if (!fs::equivalent(runner.shots(), clips)) return;
  throw InvalidArgument("the results would lie among the clips", clips,
                        "name another folder with -o");
}

void conclude_batch(const BatchRequest& request, Caller& caller, BatchResult& result) {
  const auto warn = [&](const std::string& warning) {
    result.warnings.push_back(warning);
    caller.say(MessageKind::kWarning, warning);
  };
  const auto unlisted = std::count_if(result.shots.begin(), result.shots.end(),
                                      [](const ShotResult& shot) { return !shot.listed; });
  if (!request.table.empty() && unlisted > 0) {
    warn(std::to_string(unlisted) + " clips do not stand in " + request.table);
  }
  const std::string of_all = " of " + std::to_string(result.shots.size()) + " shots ";
  if (!result.cancelled && result.failed == result.shots.size()) {
    throw Error("none of the shots could be measured", request.folder,
                "the reasons stand in " + result.table);
  }
  if (result.failed > 0) {
    warn(std::to_string(result.failed) + of_all + "failed; reasons in " + result.table +
         " and in " + (fs::path(request.output.folder) / "quarantine").string());
  }
  if (result.missing > 0 && !result.cancelled) {
    throw Error(std::to_string(result.missing) + of_all + "are missing", result.table,
                "start the processes that have not ended, or have failed, once more");
  }
}

}  // namespace impactdic::run
