// Requests refuse what is impossible, naming the setting; job files hold every setting.
#include <gtest/gtest.h>
#include <impactdic/batch.h>
#include <impactdic/correlate.h>
#include <impactdic/error.h>
#include <impactdic/track.h>

#include <cmath>
#include <functional>
#include <limits>

#include "host/run/settings/job_file.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

template <typename Request>
void expect_refused(const Request& good, const std::function<void(Request&)>& spoil,
                    const std::string& name) {
  ASSERT_NO_THROW(good.validate());
  Request request = good;
  spoil(request);
  try {
    request.validate();
    ADD_FAILURE() << name << " was not refused";
  } catch (const InvalidArgument& error) {
    EXPECT_NE(error.line().find(name), std::string::npos) << error.line();
  }
}

TrackRequest good_track() {
  TrackRequest request;
  request.clip.paths = {"clip.cine"};
  return request;
}

TEST(Requests, TrackRefusesEachImpossibleValueByName) {
  using R = TrackRequest;
  const auto refused = [](const std::function<void(R&)>& spoil, const char* name) {
    expect_refused<R>(good_track(), spoil, name);
  };
  refused([](R& r) { r.clip.paths.clear(); }, "no video");
  for (const double rate : {-1.0, kNotMeasured, kInfinite}) {
    refused([=](R& r) { r.clip.fps = rate; }, "--fps");
    refused([=](R& r) { r.ball_diameter_mm = rate; }, "--ball-diameter-mm");
    refused([=](R& r) { r.mm_per_px = rate; }, "--mm-per-px");
    refused([=](R& r) { r.inertia_factor = rate; }, "--inertia-factor");
  }
  for (const double angle : {kNotMeasured, kInfinite}) {
    refused([=](R& r) { r.surface_angle_deg = angle; }, "--surface-angle-deg");
    refused([=](R& r) { r.gravity_angle_deg = angle; }, "--gravity-angle-deg");
  }
  refused([](R& r) { r.clip.open.raw = RawLayout{64, 48, 9}; }, "--raw");
  refused([](R& r) { r.clip.open.raw = RawLayout{0, 48, 8}; }, "--raw");
  refused([](R& r) { r.frames.step = 0; }, "--frames");
  refused([](R& r) { r.frames = {5, 5, 1}; }, "--frames");
  refused([](R& r) { r.frames.first = -1; }, "--frames");
  refused([](R& r) { r.roi = Roi{0, 0, 0, 10}; }, "--roi");
  refused([](R& r) { r.roi = Roi{-1, 0, 10, 10}; }, "--roi");
  refused([](R& r) { r.radius_px = RadiusRange{9, 4}; }, "--radius-px");
  refused([](R& r) { r.radius_px = RadiusRange{0, 4}; }, "--radius-px");
  refused([](R& r) { r.radius_px = RadiusRange{kNotMeasured, 4}; }, "--radius-px");
  refused([](R& r) { r.radius_px = RadiusRange{4, kInfinite}; }, "--radius-px");
  refused([](R& r) { r.estimator = static_cast<Estimator>(7); }, "--estimator");
  refused([](R& r) { r.spacing_px = -1; }, "--spacing");
  refused([](R& r) { r.inertia_factor = 1.5; }, "--inertia-factor");
  refused([](R& r) { r.ball_diameter_mm = r.mm_per_px = 1; }, "one of");
}

TEST(Requests, FieldOptionsRefuseEachImpossibleValueByName) {
  using F = FieldOptions;
  const auto refused = [](const std::function<void(F&)>& spoil, const char* name) {
    expect_refused<F>({}, spoil, name);
    expect_refused<TrackRequest>(
        good_track(), [&](TrackRequest& r) { spoil(r.field); }, name);
  };
  refused([](F& f) { f.window_px = 4; }, "--window");
  refused([](F& f) { f.window_px = 130; }, "--window");
  refused([](F& f) { f.search_px = 0; }, "--search");
  refused([](F& f) { f.interp_points = 10; }, "--interp");
  refused([](F& f) { f.spline_degree = 4; }, "--spline-degree");
  refused([](F& f) { f.max_iterations = 0; }, "--max-iterations");
  refused([](F& f) { f.min_correlation = 1.1; }, "--min-correlation");
  refused([](F& f) { f.min_texture = kNotMeasured; }, "--min-texture");
  refused([](F& f) { f.noise = -1; }, "--noise");
  refused([](F& f) { f.max_sd_px = 0; }, "--max-sd");
  refused([](F& f) { f.method = static_cast<FieldMethod>(9); }, "--method");
}

TEST(Requests, ABatchThatIsSharedDoesToo) {
  BatchRequest batch;
  batch.folder = "shots";
  batch.output.folder = "out";
  using B = BatchRequest;
  expect_refused<B>(
      batch, [](B& r) { r.share.name = "a/b"; }, "--share");
  expect_refused<B>(
      batch, [](B& r) { r.share = {.name = "a", .shard = 3, .shards = 2}; }, "--shard");
  expect_refused<B>(
      batch, [](B& r) { r.share.lost_after_s = kNotMeasured; }, "--lost-after");
}

TEST(Requests, FoldersCorrelateBatchAndSessionsDoToo) {
  TrackFolder folder;
  folder.folder = "out";
  using T = TrackFolder;
  expect_refused<T>(
      folder, [](T& f) { f.folder.clear(); }, "--output");
  expect_refused<T>(
      folder, [](T& f) { f.compression = 10; }, "--compress");
  expect_refused<T>(
      folder, [](T& f) { f.overlay.slow_motion = -1; }, "--slow-motion");
  expect_refused<T>(
      folder, [](T& f) { f.overlay.arrow_scale = -1; }, "--arrow-scale");

  CorrelateRequest correlate;
  correlate.clip.paths = {"plate.tif"};
  using C = CorrelateRequest;
  expect_refused<C>(
      correlate,
      [](C& r) {
        r.polygon = {{0, 0}, {1, 1}};
      },
      "--polygon");
  expect_refused<C>(
      correlate,
      [](C& r) {
        r.polygon = {{0, 0}, {1, 1}, {kInfinite, 0}};
      },
      "--polygon");
  expect_refused<C>(
      correlate, [](C& r) { r.field.window_px = 1; }, "--window");
  expect_refused<C>(
      correlate, [](C& r) { r.spacing_px = -2; }, "--spacing");
  expect_refused<C>(
      correlate, [](C& r) { r.reference = static_cast<ReferenceFrame>(5); }, "--reference");
  expect_refused<C>(
      correlate, [](C& r) { r.motion = static_cast<RegionMotion>(5); }, "--motion");

  BatchRequest batch;
  batch.folder = "shots";
  batch.output.folder = "out";
  using B = BatchRequest;
  expect_refused<B>(
      batch, [](B& r) { r.folder.clear(); }, "folder");
  expect_refused<B>(
      batch, [](B& r) { r.clips = 65; }, "--clips");
  expect_refused<B>(
      batch, [](B& r) { r.track.field.window_px = 1; }, "--window");
  expect_refused<B>(
      batch, [](B& r) { r.output.folder.clear(); }, "--output");

  using S = SessionOptions;
  expect_refused<S>(
      {}, [](S& s) { s.threads = -1; }, "--threads");
  expect_refused<S>(
      {}, [](S& s) { s.device.clear(); }, "--device");
}

// Every member differs from its default; what is read back is written the same.
TEST(JobFile, EverySettingComesBackToTheLastBit) {
  TrackRequest request = good_track();
  request.clip.paths = {"a \"b\" c\\d.png", "e.png"};
  request.clip.open.raw = RawLayout{64, 48, 12};
  request.clip.fps = 1e4 / 3;
  request.frames = {3, kToTheEnd, 2};
  request.roi = Roi{1, 2, 30, 40};
  request.radius_px = RadiusRange{0.1 + 0.2, 40};
  request.estimator = Estimator::kRing;
  request.field.method = FieldMethod::kZncc;
  request.field.window_px = 17;
  request.field.max_sd_px = 1 / 3.0;
  request.field.min_texture = 2;
  request.spacing_px = 9;
  request.with_field = false;
  request.ball_diameter_mm = 66.99999999999999;
  request.surface_angle_deg = -12.5;
  request.inertia_factor = 2 / 3.0;
  TrackFolder folder;
  folder.checksum = false;
  folder.compression = 4;
  folder.overlay = {true, 30, 2.5};
  run::SettingWriter first;
  run::visit_track(first, request, folder);
  const testing::ScratchFolder scratch;
  run::write_job_file(scratch / "job.toml", "track", first.values());

  TrackRequest again;
  TrackFolder folder_again;
  const run::SettingValues read = run::read_job_file(scratch / "job.toml");
  run::visit_track(run::SettingReader(read, "job.toml"), again, folder_again);
  EXPECT_EQ(again.clip.paths, request.clip.paths);
  EXPECT_EQ(again.clip.fps, request.clip.fps);
  EXPECT_EQ(again.frames.first, 3);
  EXPECT_EQ(again.frames.end, kToTheEnd);
  EXPECT_EQ(again.frames.step, 2);
  EXPECT_EQ(again.radius_px->low_px, 0.1 + 0.2);
  EXPECT_EQ(again.field.max_sd_px, 1 / 3.0);
  EXPECT_EQ(again.ball_diameter_mm, request.ball_diameter_mm);
  EXPECT_EQ(again.inertia_factor, request.inertia_factor);
  EXPECT_FALSE(again.with_field);
  EXPECT_FALSE(folder_again.checksum);
  EXPECT_TRUE(folder_again.overlay.wanted);
  run::SettingWriter second;
  run::visit_track(second, again, folder_again);
  EXPECT_EQ(first.values(), second.values());

  // A run that goes on may have another scale, but no other window.
  EXPECT_NO_THROW(run::require_same_job(scratch / "job.toml", second));
  again.ball_diameter_mm = 60;
  run::SettingWriter scaled;
  run::visit_track(scaled, again, folder_again);
  EXPECT_NO_THROW(run::require_same_job(scratch / "job.toml", scaled));
  again.field.window_px = 19;
  run::SettingWriter other;
  run::visit_track(other, again, folder_again);
  EXPECT_THROW(run::require_same_job(scratch / "job.toml", other), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
