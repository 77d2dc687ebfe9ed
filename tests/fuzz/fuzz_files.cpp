// Any bytes as a file that the program reads: each of the readers must give a result or one of the
// library's errors. The environment's FUZZ_KIND says which reader; scripts/fuzz runs them all.
#include <impactdic/camera/model.h>
#include <impactdic/clip.h>
#include <impactdic/error.h>
#include <impactdic/live/track_live.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
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
#include "tests/fuzz/fuzz_page.h"
#include "tests/fuzz/fuzz_share.h"

namespace {

namespace fs = std::filesystem;
using namespace impactdic;

struct Scratch {
  fs::path folder;
  Scratch() {
    std::string name = (fs::temp_directory_path() / "impactdic_fuzz_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    folder = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};
const fs::path& scratch() {
  static const Scratch made;
  return made.folder;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void read_frames(const fs::path& path, const OpenOptions& options = {}) {
  const auto clip = open_clip({path.string()}, options);
  const ClipInfo& info = clip->info();
  Frame frame;
  clip->read(0, frame);
  clip->read(info.frame_count - 1, frame);
  clip->frame_time_s(0);
  clip->frame_exposure_s(0);
  if (frame.width() != info.width || frame.height() != info.height) std::abort();
}

struct Kind {
  const char* name;  // of the file
  void (*read)(const fs::path&);
};

void read_clip(const fs::path& path) { read_frames(path); }
void read_raw(const fs::path& path) {
  OpenOptions options;
  options.raw = RawLayout{17, 5, 12};
  read_frames(path, options);
}
void read_photron(const fs::path& path) {
  static const std::string pixels(4096, '\x5a');
  std::ofstream(scratch() / "a.mraw", std::ios::binary) << pixels;
  read_frames(path);
}
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
// The standard input of `track --live`.
void read_stream(const fs::path& path) {
  for (const int bits : {8, 10, 12, 16}) {
    const auto stream = open_raw_stream(path.string(), RawLayout{16, 4, bits});
    Frame frame;
    try {
      while (stream->next(frame)) {
        if (frame.width() != 16 || frame.height() != 4) std::abort();
      }
    } catch (const FormatError&) {  // it ends within a frame
    }
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

const std::map<std::string, Kind> kKinds = {
    {"cine", {"a.cine", read_clip}},
    {"cihx", {"a.cihx", read_photron}},
    {"cih", {"a.cih", read_photron}},
    {"seq", {"a.seq", read_clip}},
    {"tiff", {"a.tif", read_clip}},
    {"raw", {"a.raw", read_raw}},
    {"png", {"a.png", read_clip}},
    {"jpeg", {"a.jpg", read_clip}},
    {"bmp", {"a.bmp", read_clip}},
    {"pgm", {"a.pgm", read_clip}},
    {"avi", {"a.avi", read_clip}},
    {"mp4", {"a.mp4", read_clip}},
    {"job", {"a.toml", [](const fs::path& path) { run::read_job_file(path); }}},
    {"simulate_job", {"a.toml", [](const fs::path& path) { sim::job::read_simulate_job(path); }}},
    {"rebound_job", {"a.toml", [](const fs::path& path) { sim::job::read_rebound_job(path); }}},
    {"rod_job", {"a.toml", [](const fs::path& path) { sim::rod::read_rod_job(path); }}},
    {"fit_job", {"a.toml", [](const fs::path& path) { sim::fit::read_fit_job(path); }}},
    {"compare_job", {"a.toml", [](const fs::path& path) { sim::compare::read_compare_job(path); }}},
    {"rod_compare_job",
     {"a.toml", [](const fs::path& path) { sim::compare::read_rod_compare_job(path); }}},
    {"sweep_job", {"a.toml", read_sweep}},
    {"camera", {"camera.toml", read_calibration}},
    {"stream", {"a.raw", read_stream}},
    {"shot_line", {"a.json", read_shot_line}},
    {"share", {"a.txt", [](const fs::path& path) { fuzz::read_share(text_of(path)); }}},
    {"launch", {"a.txt", [](const fs::path& path) { fuzz::read_launch(text_of(path)); }}},
    {"page", {"a.txt", [](const fs::path& path) { fuzz::ask_page(text_of(path), scratch()); }}},
    {"page_fields", {"fields.h5", fuzz::show_fields}},
    {"page_job", {"job.toml", fuzz::show_job}},
    {"target", {"a.raw", [](const fs::path& path) { fuzz::find_target(text_of(path)); }}},
    {"table", {"a.csv", [](const fs::path& path) { CsvTable::read(path); }}},
    {"shot_table", {"a.csv", read_shots_of_table}},
    {"markers", {"a.csv", [](const fs::path& path) { sim::rod::read_markers(path); }}},
    {"deformations", {"a.csv", [](const fs::path& path) { sim::rod::read_deformations(path); }}},
    {"printed", {"a.csv", [](const fs::path& path) { sim::shot::read_printed(path); }}},
    {"track", {"a.csv", [](const fs::path& path) { sim::shot::read_track(path); }}},
    {"motion_given", {"a.csv", [](const fs::path& path) { sim::speckle::read_motion_csv(path); }}},
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

const Kind& kind() {
  const char* const name = std::getenv("FUZZ_KIND");
  const auto found = kKinds.find(name == nullptr ? "" : name);
  if (found != kKinds.end()) return found->second;
  for (const auto& [known, of] : kKinds) std::printf("%s\n", known.c_str());
  std::fflush(stdout);
  std::_Exit(2);  // without the fuzzer's last words
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  static const Kind& tried = kind();
  const fs::path path = scratch() / tried.name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  try {
    tried.read(path);
  } catch (const Error&) {
  }
  return 0;
}
