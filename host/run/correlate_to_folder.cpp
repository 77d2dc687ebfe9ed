// `correlate` with files at its edge.
#include <impactdic/error.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/base/stopwatch.h"
#include "host/report/advice_json.h"
#include "host/report/csv.h"
#include "host/report/fields_file.h"
#include "host/report/resume_file.h"
#include "host/report/summary.h"
#include "host/run/correlate_run.h"
#include "host/run/folder.h"
#include "host/run/open_clip.h"
#include "host/run/results/result_digests.h"
#include "host/run/settings/job_file.h"

namespace impactdic {

void CorrelateFolder::validate() const {
  if (folder.empty()) throw InvalidArgument("the output folder has no name", "--output");
  run::check_compression(compression);
}

namespace {

namespace fs = std::filesystem;

// Between two writes to the disk, as for `track`.
constexpr double kFlushFieldsEvery_s = 0.5;

// What a run leaves behind, written while the clip runs.
class CorrelateFiles {
 public:
  // With `resume` keeps what an earlier run finished. Throws FileError, FormatError.
  CorrelateFiles(const fs::path& folder, const CorrelateRequest& request, std::size_t windows,
                 const report::Attributes& attributes, int compression, bool resume)
      : folder_(folder) {
    if (resume) {
      from_ = report::read_correlate_point(resume_path());
      rows_ = report::read_motion_csv(folder / "motion.csv");
    }
    const auto keep = from_ ? static_cast<std::size_t>(from_->next_row) : 0;
    table_.emplace(folder / "motion.csv", keep);  // refuses a table that is too short
    rows_.resize(keep);
    const int window_px = request.field.window_px;
    const fs::path fields = folder / "fields.h5";
    fields_.emplace(
        keep > 0 ? report::FieldsFile::resume(fields, window_px, keep, !request.camera.empty())
                 : report::FieldsFile::create(fields, windows, window_px, attributes, compression,
                                              !request.camera.empty()));
  }

  const std::optional<pipeline::CorrelatePoint>& from() const { return from_; }
  std::vector<MotionRow>& rows() { return rows_; }
  report::FieldsFile& fields() { return *fields_; }
  void add(const MotionRow& row, std::span<const Window> windows,
           std::span<const WindowMotion> field, std::span<const PlaneResult> plane) {
    table_->add(row);
    fields_->add(row.frame, row.time_s, windows, field, nullptr, plane);
  }
  void reach(const pipeline::CorrelatePoint& point) {
    reached_ = point;
    if (since_flush_.seconds() > kFlushFieldsEvery_s) flush();
  }
  // The point last: all that it promises is on the disk then.
  void flush() {
    fields_->flush();
    table_->flush();
    if (reached_) report::write_resume_point(resume_path(), *reached_);
    since_flush_ = {};
  }

 private:
  fs::path resume_path() const { return folder_ / "resume.json"; }

  fs::path folder_;
  std::optional<pipeline::CorrelatePoint> from_, reached_;
  std::vector<MotionRow> rows_;
  std::optional<report::MotionCsv> table_;
  std::optional<report::FieldsFile> fields_;
  Stopwatch since_flush_;
};

nlohmann::json describe_floor(const CorrelateResult& result) {
  if (!result.noise_floor) return nullptr;
  const NoiseFloor& floor = *result.noise_floor;
  nlohmann::json described = {{"frames", {floor.first_frame, floor.last_frame}},
                              {"windows", floor.windows},
                              {"mean_px", {floor.u_mean, floor.v_mean}},
                              {"spatial_sd_px", {floor.u_spatial_sd, floor.v_spatial_sd}},
                              {"temporal_sd_px", {floor.u_temporal_sd, floor.v_temporal_sd}},
                              {"stated_sd_px", {floor.u_stated_sd, floor.v_stated_sd}}};
  if (result.camera) {
    const double unit = result.camera->metre_per_px.value;
    described["spatial_sd_m"] = {floor.u_spatial_sd * unit, floor.v_spatial_sd * unit};
    described["temporal_sd_m"] = {floor.u_temporal_sd * unit, floor.v_temporal_sd * unit};
  }
  return described;
}

nlohmann::json summarise(const CorrelateRequest& request, const CorrelateResult& result,
                         const Session& session) {
  nlohmann::json summary = {{"device", run::describe_device(session)},
                            {"frames_analysed", result.rows.size()},
                            {"frames_measured", result.frames_measured},
                            {"windows", result.windows},
                            {"frames_per_s", result.frames_per_s},
                            {"advice", report::describe_advice(result.advice)},
                            {"noise_floor", describe_floor(result)},
                            {"camera", nullptr},
                            {"warnings", result.warnings}};
  if (result.camera) {
    const PlaneFigures& camera = *result.camera;
    const auto known = [](double value) {
      return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
    };
    summary["camera"] = {
        {"file", request.camera},
        {"from", camera.from},
        {"m_per_px", {{"value", camera.metre_per_px.value}, {"sd", camera.metre_per_px.sd}}},
        {"tilt_deg", known(camera.tilt_deg)},
        {"distortion_px", camera.distortion_px}};
  }
  if (result.cancelled) summary["cancelled"] = true;
  return summary;
}

}  // namespace

CorrelateResult correlate_to_folder(const CorrelateRequest& request, const CorrelateFolder& folder,
                                    Session& session, const RunControl& control) {
  folder.validate();
  run::Caller caller(control);
  CorrelateResult result;
  run::CorrelateRun run(request, session, caller, result);
  const run::OutputFolder output(folder.folder, folder.force || folder.resume);
  const fs::path& path = output.path();
  run::SettingWriter settings;
  run::visit_correlate(settings, request, folder);
  report::Attributes attributes = run::attributes_of(session, run.info());
  settings.describe(attributes);
  run::visit_session(settings, session.options());
  const bool going_on = folder.resume && fs::exists(path / "resume.json");
  if (going_on) run::require_same_job(path / "job.toml", settings);
  run::begin_results(path, "correlate", settings, going_on);
  run.look();

  auto files = std::make_unique<CorrelateFiles>(path, request, run.windows().size(), attributes,
                                                folder.compression, going_on);
  if (files->from()) run.go_on(*files->from(), std::move(files->rows()));
  run::DigestBeside digest(request.clip, run.info(), true);
  const auto finish = [&] {
    files->flush();
    const double unit = result.camera ? result.camera->metre_per_px.value : 0;
    files->fields().set_scale(unit, result.fps / static_cast<double>(result.frames.step),
                              kNotMeasured, request.camera);
    const video::ClipDigest found = digest.get();
    if (digest.wanted()) files->fields().set_source_digest(found);
    nlohmann::json summary = summarise(request, result, session);
    summary["input"] = report::describe_input(run.info(), found);
    report::write_json(path / "summary.json", summary);
    files.reset();
    run::write_digests(path);
  };
  try {
    run.measure(
        [&](const MotionRow& row, std::span<const WindowMotion> field,
            std::span<const PlaneResult> plane) { files->add(row, run.windows(), field, plane); },
        [&](const pipeline::CorrelatePoint& point) { files->reach(point); });
  } catch (...) {
    finish();  // what was measured is kept
    throw;
  }
  finish();
  return result;
}

}  // namespace impactdic
