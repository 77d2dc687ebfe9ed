#include "host/app/track_output.h"

#include <impactdic/error.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/base/stopwatch.h"
#include "host/report/pose_csv.h"
#include "host/report/resume_file.h"

namespace impactdic::app {

namespace {
// Between two writes to the disk: a killed run loses no more than this and the frames in flight.
constexpr double kFlushEvery_s = 0.5;
}  // namespace

struct TrackOutput::Impl {
  OutputOptions options;
  std::vector<TrackRow> rows;
  std::optional<pipeline::ResumePoint> from, reached;
  std::unique_ptr<report::TrackCsv> csv;
  std::unique_ptr<report::PoseCsv> poses;
  std::unique_ptr<report::FieldsFile> fields;
  std::unique_ptr<OverlayOutput> overlay;
  std::vector<TrackRow> before_grid;  // rows without a ball, before the field's size is known
  std::size_t in_csv = 0;             // rows
  Stopwatch since_flush;
  std::string impact_line;

  std::filesystem::path csv_path() const { return options.folder / "track.csv"; }
  std::filesystem::path fields_path() const { return options.folder / "fields.h5"; }
  std::filesystem::path resume_path() const { return options.folder / "resume.json"; }

  // Every row before the point that was reached is final; what stands behind it is measured again.
  void take_over() {
    if (!options.resume || !std::filesystem::exists(resume_path())) return;
    pipeline::ResumePoint point = report::read_resume_point(resume_path());
    const auto done = static_cast<std::size_t>(point.next_row);
    std::vector<TrackRow> earlier = report::read_track_csv(csv_path());
    if (earlier.size() < done) {
      throw FormatError(csv_path().string(), -1,
                        "it holds " + std::to_string(earlier.size()) + " of the " +
                            std::to_string(done) + " frames that were measured",
                        "--force without --resume starts anew");
    }
    earlier.resize(done);
    if (options.with_field && point.grid_radius_px) {
      fields = std::make_unique<report::FieldsFile>(
          report::FieldsFile::resume(fields_path(), options.window_px, done));
    } else if (options.with_field) {
      before_grid = earlier;
    }
    rows = std::move(earlier);
    from = reached = std::move(point);
  }

  void write_field(const TrackRow& row, const motion::PairMotion* pair) {
    if (!options.with_field) return;
    if (!fields) {
      before_grid.push_back(row);
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
    for (const TrackRow& row : before_grid) write_field(row, nullptr);
    before_grid.clear();
  }

  // The point last: all that it promises is on the disk then.
  void flush() {
    if (poses) poses->flush();
    if (fields) fields->flush();
    for (; in_csv < rows.size(); ++in_csv) csv->add(rows[in_csv]);
    csv->flush();
    if (reached) report::write_resume_point(resume_path(), *reached);
    since_flush = {};
  }
};

TrackOutput::TrackOutput(OutputOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->take_over();
  if (!impl_->from) std::filesystem::remove(impl_->resume_path());
  impl_->csv =
      std::make_unique<report::TrackCsv>(impl_->csv_path(), impl_->options.scale, impl_->rows);
  impl_->in_csv = impl_->rows.size();
  if (impl_->options.with_poses) {
    impl_->poses =
        std::make_unique<report::PoseCsv>(impl_->options.folder / "pose.csv", impl_->rows.size());
  }
  if (impl_->options.overlay.wanted) {
    impl_->overlay = std::make_unique<OverlayOutput>(impl_->options.folder, impl_->options.overlay,
                                                     impl_->options.roi, impl_->rows);
  }
}

TrackOutput::~TrackOutput() = default;

const std::optional<pipeline::ResumePoint>& TrackOutput::resume_point() const {
  return impl_->from;
}
const std::vector<TrackRow>& TrackOutput::rows() const { return impl_->rows; }
const std::string& TrackOutput::impact_line() const { return impl_->impact_line; }

void TrackOutput::set_grid(std::span<const Window> grid, double radius_px) {
  impl_->open_fields(grid.size(), radius_px);
}

void TrackOutput::add(const pipeline::TrackedFrame& frame) {
  impl_->rows.push_back(frame.row);
  if (impl_->poses) impl_->poses->add(frame.row);
  impl_->write_field(frame.row, frame.pair);
  if (impl_->overlay) {
    impl_->overlay->add(frame, impl_->options.window_px);
  }
}

void TrackOutput::reach(const pipeline::ResumePoint& point) {
  impl_->reached = point;
  if (impl_->since_flush.seconds() > kFlushEvery_s) impl_->flush();
}

void TrackOutput::set_source_digest(const video::ClipDigest& digest) {
  if (impl_->fields) impl_->fields->set_source_digest(digest);
}

nlohmann::json TrackOutput::finish() {
  SiScale scale = impl_->options.scale;
  const auto radius = median_radius_px(impl_->rows);
  if (impl_->options.ball_diameter_m > 0 && radius) {
    scale.metre_per_px = impl_->options.ball_diameter_m / (2 * *radius);
  }
  // A clip without any ball still gets its (empty) field file.
  if (impl_->options.with_field) impl_->open_fields(0, 0);
  impl_->flush();
  impl_->csv->finish(impl_->rows, scale);
  nlohmann::json summary = report::summarise_track(impl_->rows, scale);
  const report::ImpactSetup& setup = impl_->options.impact;
  const impact::ImpactAnalysis impact =
      impact::analyse_impact(impl_->rows, report::impact_options(scale, setup));
  summary["impact"] = report::describe_impact(impact, impl_->rows, scale, setup);
  impl_->impact_line = report::impact_in_a_line(summary["impact"]);
  if (impl_->overlay) impl_->overlay->finish(impl_->rows, scale, summary["impact"]);
  return summary;
}

}  // namespace impactdic::app
