// What the program writes for itself, jobs and tables, and what its page is asked.
#include <impactdic/camera/model.h>
#include <impactdic/error.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "host/base/csv_table.h"
#include "host/opencl/program_cache.h"
#include "host/report/csv.h"
#include "host/report/fields_file.h"
#include "host/report/journaled_file.h"
#include "host/report/resume_file.h"
#include "host/report/shots_csv.h"
#include "host/run/batch/shot_line.h"
#include "host/run/batch_table.h"
#include "host/run/results/folder_lock.h"
#include "host/run/results/result_digests.h"
#include "host/run/settings/job_file.h"
#include "sim/compare/compare_job.h"
#include "sim/compare/rod_comparison.h"
#include "sim/fit/fit_job.h"
#include "sim/job/job_toml.h"
#include "sim/job/rebound_job.h"
#include "sim/rod/markers.h"
#include "sim/rod/rod_job.h"
#include "sim/shot/shot_table.h"
#include "sim/shot/track_table.h"
#include "sim/speckle/motion.h"
#include "sim/sweep/sweep_job.h"
#include "tests/fuzz/fuzz_kind.h"
#include "tests/fuzz/fuzz_page.h"

namespace impactdic::fuzz {
namespace {

namespace fs = std::filesystem;

void read_shots_of_table(const fs::path& path) {
  std::vector<run::BatchShot> shots(3);
  for (int i = 0; i < 3; ++i) {
    shots[i].name = "shot_" + std::to_string(i);
    shots[i].clip = shots[i].name + ".tif";
  }
  run::read_shot_table(path, shots);
  for (const run::BatchShot& shot : shots) {
    ShotResult result;
    result.file = shot.name;
    result.notes = shot.notes;
    result.drop_height_mm = shot.drop_height_mm;
    if (report::shots_csv_line(result).find('\n') != std::string::npos) std::abort();
  }
}
void read_summary(const fs::path& path) {
  ShotResult shot;
  report::read_shot(shot, path);
}
void read_journal(const fs::path& path) {
  std::ofstream(scratch() / "f") << "a file of an earlier run";
  fs::rename(path, report::JournaledFile::journal_of(scratch() / "f"));
  try {
    report::JournaledFile::open(scratch() / "f");
  } catch (const Error&) {
    fs::remove(report::JournaledFile::journal_of(scratch() / "f"));
    throw;
  }
}
// What is read must come back from what we write of it.
void read_calibration(const fs::path& path) {
  const Camera camera = read_camera(path.string());
  write_camera(camera, (scratch() / "again.toml").string());
  if (read_camera((scratch() / "again.toml").string()).values != camera.values) std::abort();
}
void read_sweep(const fs::path& path) {
  sim::sweep::is_sweep_job(path);
  const std::string text = sim::sweep::to_toml(sim::sweep::read_sweep_job(path));
  const fs::path again = scratch() / "again.toml";
  std::ofstream(again) << text;
  if (sim::sweep::to_toml(sim::sweep::read_sweep_job(again)) != text) std::abort();
}
void read_shot_line(const fs::path& path) {
  const std::string text = text_of(path);
  const std::string line = run::to_line(run::parse_shot_line(text, "ticket"));
  if (run::to_line(run::parse_shot_line(line, "ticket")) != line) std::abort();
}
void read_lock(const fs::path&) { const run::FolderLock lock(scratch()); }
void read_cache(const fs::path& path) {
  // Whatever its name: an entry is believed only where it holds key and digest, as one that is
  // stored anew would.
  const opencl::ProgramCache cache(scratch());
  cache.store("key", {1, 2, 3});
  for (const auto& entry : fs::directory_iterator(scratch())) {
    if (entry.path().extension() != ".clbin") continue;
    fs::copy_file(path, entry.path(), fs::copy_options::overwrite_existing);
  }
  const auto binary = cache.load("key");
  if (!binary) return;
  cache.store("key", *binary);
  for (const auto& entry : fs::directory_iterator(scratch())) {
    if (entry.path().extension() == ".clbin" && text_of(entry.path()) != text_of(path))
      std::abort();
  }
}

}  // namespace

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> all = {
      {"job", {"a.toml", [](const fs::path& path) { run::read_job_file(path); }}},
      {"simulate_job", {"a.toml", [](const fs::path& path) { sim::job::read_simulate_job(path); }}},
      {"rebound_job", {"a.toml", [](const fs::path& path) { sim::job::read_rebound_job(path); }}},
      {"rod_job", {"a.toml", [](const fs::path& path) { sim::rod::read_rod_job(path); }}},
      {"fit_job", {"a.toml", [](const fs::path& path) { sim::fit::read_fit_job(path); }}},
      {"compare_job",
       {"a.toml", [](const fs::path& path) { sim::compare::read_compare_job(path); }}},
      {"rod_compare_job",
       {"a.toml", [](const fs::path& path) { sim::compare::read_rod_compare_job(path); }}},
      {"sweep_job", {"a.toml", read_sweep}},
      {"camera", {"camera.toml", read_calibration}},
      {"shot_line", {"a.json", read_shot_line}},
      {"page", {"a.txt", [](const fs::path& path) { ask_page(text_of(path), scratch()); }}},
      {"page_fields", {"fields.h5", show_fields}},
      {"page_job", {"job.toml", show_job}},
      {"table", {"a.csv", [](const fs::path& path) { CsvTable::read(path); }}},
      {"shot_table", {"a.csv", read_shots_of_table}},
      {"markers", {"a.csv", [](const fs::path& path) { sim::rod::read_markers(path); }}},
      {"deformations", {"a.csv", [](const fs::path& path) { sim::rod::read_deformations(path); }}},
      {"printed", {"a.csv", [](const fs::path& path) { sim::shot::read_printed(path); }}},
      {"track", {"a.csv", [](const fs::path& path) { sim::shot::read_track(path); }}},
      {"motion_given",
       {"a.csv", [](const fs::path& path) { sim::speckle::read_motion_csv(path); }}},
      {"track_csv", {"track.csv", [](const fs::path& path) { report::read_track_csv(path); }}},
      {"motion_csv", {"motion.csv", [](const fs::path& path) { report::read_motion_csv(path); }}},
      {"resume", {"resume.json", [](const fs::path& path) { report::read_resume_point(path); }}},
      {"resume_correlate",
       {"resume.json", [](const fs::path& path) { report::read_correlate_point(path); }}},
      {"summary", {"summary.json", read_summary}},
      {"fields",
       {"fields.h5", [](const fs::path& path) { report::FieldsFile::resume(path, 15, 3); }}},
      {"journal", {"journal", read_journal}},
      {"digests", {"SHA256SUMS", [](const fs::path&) { run::check_digests(scratch()); }}},
      {"lock", {run::FolderLock::kName, read_lock}},
      {"cache", {"entry", read_cache}},
  };
  return all;
}

}  // namespace impactdic::fuzz
