#include "host/run/batch/shot_runner.h"

#include <impactdic/error.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "host/report/shots_csv.h"
#include "host/report/words.h"
#include "host/run/settings/job_file.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAtOnce = 4;

}  // namespace

std::size_t clips_in_flight(int asked, int threads, std::size_t waiting) {
  const int cores = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  const int wanted = asked > 0 ? asked : std::clamp(cores, 1, kMostAtOnce);
  return std::clamp<std::size_t>(waiting, 1, static_cast<std::size_t>(wanted));
}

ShotRunner::ShotRunner(const BatchRequest& request, Session& session, Caller& caller)
    : request_(request), session_(session), caller_(caller), output_(request.output.folder) {}

ShotResult ShotRunner::described(const BatchShot& shot) const {
  ShotResult entry;
  entry.file = shot.clip.filename().string();
  entry.name = shot.name;
  entry.listed = shot.listed;
  entry.drop_height_mm = shot.drop_height_mm;
  entry.notes = shot.notes;
  entry.ball = shot.ball;
  entry.mass_g = shot.mass_g;
  const TrackRequest of_it = request_of(shot);
  of_it.validate();
  if (of_it.ball_diameter_mm > 0) entry.ball_diameter_mm = of_it.ball_diameter_mm;
  if (of_it.inertia_factor > 0) entry.inertia_factor = of_it.inertia_factor;
  return entry;
}

TrackRequest ShotRunner::request_of(const BatchShot& shot) const {
  TrackRequest request = request_.track;
  request.clip.source = nullptr;
  request.clip.paths = {shot.clip.string()};
  if (shot.surface_angle_deg) request.surface_angle_deg = *shot.surface_angle_deg;
  if (shot.ball_diameter_mm) {
    request.ball_diameter_mm = *shot.ball_diameter_mm;
    request.mm_per_px = request.mm_per_px_sd = 0;  // the shot's own scale
  }
  if (!shot.camera.empty()) {
    request.camera = shot.camera;
    request.mm_per_px = request.mm_per_px_sd = 0;
  }
  if (shot.inertia_factor) request.inertia_factor = *shot.inertia_factor;
  if (shot.height_mm) request.drop_height_mm = *shot.height_mm;
  return request;
}

TrackFolder ShotRunner::folder_of(const fs::path& into) const {
  TrackFolder folder = request_.output;
  folder.folder = into.string();
  folder.force = true;
  folder.keep_rows = false;
  return folder;
}

bool ShotRunner::is_settled(const BatchShot& shot, const fs::path& part) const {
  const TrackRequest request = request_of(shot);
  const TrackFolder folder = folder_of(part);
  SettingWriter settings;
  visit_track(settings, request, folder);
  visit_session(settings, session_.options());
  for (const fs::path& earlier : {done(shot), part}) {
    if (fs::exists(earlier / "job.toml")) require_same_job(earlier / "job.toml", settings);
  }
  return is_done(shot) && same_afterwards(done(shot) / "job.toml", settings);
}

std::string ShotRunner::measure(const BatchShot& shot, const fs::path& into, ShotResult& result,
                                const std::function<void()>& alive) const {
  TrackRequest request = request_of(shot);
  const TrackFolder folder = folder_of(into);
  // What was corrected by hand in the shot itself stays.
  if (folder.resume && fs::exists(into / "job.toml") && request.ball_at.empty()) {
    request.ball_at = corrections_of(into / "job.toml");
  }
  // The batch speaks for its shots.
  RunControl control;
  control.cancelled = [&] {
    if (alive) alive();
    return caller_.cancelled();
  };
  control.message = [this](const Message& message) {
    if (message.kind == MessageKind::kTiming) caller_.say(message.kind, message.text);
  };
  try {
    fs::create_directories(into);
    const TrackResult measured = track_to_folder(request, folder, session_, control);
    if (measured.cancelled) return "the run was cancelled";
    if (measured.frames_ok == 0) return "no ball was measured in any frame";
    report::fill_shot(result, measured);
    result.done = result.measured_now = true;
    caller_.say(MessageKind::kNote, shot.name + ": " + std::to_string(measured.frames_ok) + " of " +
                                        std::to_string(measured.frames.count()) + " frames ok; " +
                                        report::in_words(measured.impact_si));
    warn_of_contradictions(result);
    return "";
  } catch (const OpenClError&) {
    throw;  // the device fails for every shot
  } catch (const Error& error) {
    return error.line();
  } catch (const std::exception& error) {
    return error.what();
  }
}

ShotResult ShotRunner::read_done(const BatchShot& shot) const {
  ShotResult result = described(shot);
  result.done = true;
  report::read_shot(result, done(shot) / "summary.json");
  return result;
}

void ShotRunner::put_aside(const BatchShot& shot, const fs::path& part,
                           const std::string& reason) const {
  fs::create_directories(part);
  std::ofstream file(part / "reason.txt");
  file << reason << '\n' << std::flush;
  if (!file) throw FileError("cannot write the file", (part / "reason.txt").string());
  file.close();
  fs::create_directories(aside(shot).parent_path());
  fs::remove_all(aside(shot));
  fs::rename(part, aside(shot));
  caller_.say(MessageKind::kWarning, shot.name + ": " + reason);
}

void ShotRunner::warn_of_contradictions(const ShotResult& shot) const {
  for (const Contradiction& found : shot.impact.contradictions) {
    caller_.say(MessageKind::kWarning, shot.name + ": " + found.message);
  }
}

}  // namespace impactdic::run
