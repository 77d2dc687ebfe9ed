#include "host/run/track/track_files.h"

#include <impactdic/error.h>

#include <utility>

#include "host/base/stopwatch.h"
#include "host/report/csv.h"
#include "host/report/picture/overlay_files.h"
#include "host/report/pose_csv.h"
#include "host/report/resume_file.h"
#include "host/run/results/kept_points.h"

namespace impactdic::run {

namespace {
// Between two writes to the disk: a killed run loses no more than this and the frames in flight.
constexpr double kFlushEvery_s = 0.5;
}  // namespace

struct TrackFiles::Impl {
  TrackFilesOptions options;
  std::vector<TrackRow> earlier;
  bool complete = false;
  std::optional<pipeline::ResumePoint> from, reached;
  std::unique_ptr<KeptPoints> points;
  std::unique_ptr<report::TrackCsv> csv;
  std::unique_ptr<report::PoseCsv> poses;
  std::unique_ptr<report::FieldsFile> fields;
  std::unique_ptr<report::OverlayFiles> overlay;
  // Frames without a ball, before the field's size is known: their numbers and times.
  std::vector<std::pair<std::int64_t, double>> before_grid;
  std::vector<TrackRow> not_in_csv;
  Stopwatch since_flush;

  std::filesystem::path csv_path() const { return options.folder / "track.csv"; }
  std::filesystem::path fields_path() const { return options.folder / "fields.h5"; }
  std::filesystem::path resume_path() const { return options.folder / "resume.json"; }

  // Every row before the point that was reached is final; what stands behind it is measured again.
  void take_over() {
    if (!options.resume) return;
    earlier = report::read_track_csv(csv_path());
    complete = static_cast<std::int64_t>(earlier.size()) == options.rows;
    if (!complete) {
      from = reached = report::read_resume_point(resume_path());
      const auto done = static_cast<std::size_t>(from->next_row);
      // The table says itself where it holds fewer.
      if (earlier.size() > done) earlier.resize(done);
    }
    if (options.with_poses) report::read_pose_csv(options.folder / "pose.csv", earlier);
    if (options.with_field && (complete || from->grid_radius_px)) {
      fields = std::make_unique<report::FieldsFile>(
          report::FieldsFile::resume(fields_path(), options.window_px, earlier.size()));
    } else if (options.with_field) {
      for (const TrackRow& row : earlier) before_grid.emplace_back(row.frame, row.time_s);
    }
  }

  void write_field(const TrackRow& row, const motion::PairMotion* pair) {
    if (!options.with_field) return;
    if (!fields) {
      before_grid.emplace_back(row.frame, row.time_s);
      return;
    }
    if (pair != nullptr) {
      fields->add(row.frame, row.time_s, pair->windows, pair->field, &row);
    } else {
      fields->add(row.frame, row.time_s, {}, {}, &row);
    }
  }

  void open_fields(std::size_t window_count, double radius_px) {
    if (fields) return;
    options.attributes["grid_radius_px"] = radius_px;
    fields = std::make_unique<report::FieldsFile>(report::FieldsFile::create(
        fields_path(), window_count, options.window_px, options.attributes, options.compression));
    for (const auto& [frame, time_s] : before_grid) fields->add(frame, time_s, {}, {}, nullptr);
    before_grid = {};
  }

  // The point last: all that it promises is on the disk then.
  void flush() {
    if (poses) poses->flush();
    if (fields) fields->flush();
    csv->add(not_in_csv);
    not_in_csv.clear();
    csv->flush();
    if (reached) {
      report::write_resume_point(resume_path(), *reached);
      points->add(*reached);
    }
    since_flush = {};
  }
};

TrackFiles::TrackFiles(TrackFilesOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->take_over();
  const auto keep =
      impl_->from ? impl_->from->next_row : static_cast<std::int64_t>(impl_->earlier.size());
  impl_->points = std::make_unique<KeptPoints>(impl_->options.folder, keep);
  impl_->csv = std::make_unique<report::TrackCsv>(impl_->csv_path(), impl_->options.scale, keep);
  if (impl_->options.with_poses) {
    impl_->poses = std::make_unique<report::PoseCsv>(impl_->options.folder / "pose.csv", keep);
  }
  if (impl_->options.overlay.wanted) {
    impl_->overlay = std::make_unique<report::OverlayFiles>(
        impl_->options.folder, impl_->options.overlay, impl_->options.roi, impl_->earlier);
  }
}

TrackFiles::~TrackFiles() = default;

bool TrackFiles::can_go_on(const std::filesystem::path& folder, std::int64_t rows) {
  if (std::filesystem::exists(folder / "resume.json")) return true;
  // A short clip is measured before there is a point to go on from.
  const std::filesystem::path table = folder / "track.csv";
  try {
    return std::filesystem::exists(table) &&
           static_cast<std::int64_t>(report::read_track_csv(table).size()) == rows;
  } catch (const FormatError&) {
    return false;  // killed before its first row
  }
}

bool TrackFiles::is_complete() const { return impl_->complete; }

const std::optional<pipeline::ResumePoint>& TrackFiles::resume_point() const { return impl_->from; }
std::vector<TrackRow> TrackFiles::take_earlier_rows() { return std::move(impl_->earlier); }

void TrackFiles::set_grid(std::span<const Window> grid, double radius_px) {
  impl_->open_fields(grid.size(), radius_px);
}

void TrackFiles::add(const pipeline::TrackedFrame& frame) {
  impl_->not_in_csv.push_back(frame.row);
  if (impl_->poses) impl_->poses->add(frame.row);
  impl_->write_field(frame.row, frame.pair);
  if (impl_->overlay) {
    impl_->overlay->add(frame, impl_->options.window_px);
  }
}

void TrackFiles::reach(const pipeline::ResumePoint& point) {
  impl_->reached = point;
  if (impl_->since_flush.seconds() > kFlushEvery_s) impl_->flush();
}

void TrackFiles::set_source_digest(const video::ClipDigest& digest) {
  if (impl_->fields) impl_->fields->set_source_digest(digest);
}

void TrackFiles::finish(const TrackRows& rows, const TrackResult& result) {
  // A clip without any ball still gets its (empty) field file.
  if (impl_->options.with_field) impl_->open_fields(0, 0);
  impl_->flush();
  if (impl_->fields) {
    impl_->fields->set_scale(result.scale.metre_per_px, result.scale.fps,
                             result.scale.surface_angle_rad * kDegPerRad, impl_->options.camera);
  }
  impl_->csv->finish(rows, result);
  const std::filesystem::path motion = impl_->options.folder / "camera_motion.csv";
  if (result.camera_motion) {
    report::write_camera_motion_csv(motion, rows, *result.camera_motion);
  } else {
    std::filesystem::remove(motion);  // of an earlier run that this one went on with
  }
  if (impl_->overlay) impl_->overlay->finish(result);
}

}  // namespace impactdic::run
