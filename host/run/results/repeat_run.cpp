#include "host/run/results/repeat_run.h"

#include <impactdic/correlate.h>
#include <impactdic/error.h>
#include <impactdic/track.h>

#include "host/base/private_folder.h"
#include "host/base/sha256.h"
#include "host/run/settings/job_file.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<RepeatedFile> repeat_run(const fs::path& folder, const RunControl& control) {
  const fs::path job = folder / "job.toml";
  const SettingValues values = read_job_file(job);
  const SettingReader reader(values, job.string());
  SessionOptions options;
  visit_session(reader, options);
  Session session(options);
  const ScratchFolder scratch;
  const auto found = values.find("command");
  const std::string command = found == values.end() ? "" : to_text(found->second);
  if (command == "track") {
    TrackRequest request;
    TrackFolder output;
    visit_track(reader, request, output);
    output.folder = scratch.path().string();
    output.checksum = output.overlay.wanted = false;
    track_to_folder(request, output, session, control);
  } else if (command == "correlate") {
    CorrelateRequest request;
    CorrelateFolder output;
    visit_correlate(reader, request, output);
    output.folder = scratch.path().string();
    correlate_to_folder(request, output, session, control);
  } else {
    throw InvalidArgument("'" + command + "' is not repeated", job.string(),
                          "results of track and correlate are; of a batch, those in its shots");
  }
  std::vector<RepeatedFile> files;
  for (const char* name : {"track.csv", "pose.csv", "motion.csv"}) {
    if (!fs::exists(folder / name)) continue;
    files.push_back({name, fs::exists(scratch.path() / name) &&
                               sha256_of_file((folder / name).string()) ==
                                   sha256_of_file((scratch.path() / name).string())});
  }
  return files;
}

}  // namespace impactdic::run
