// Film that a recorder, a converter or a coder has changed: frames that come twice, frames that are
// missing, grey levels that are not light, noise that is alike in pixels that touch.
#include <gtest/gtest.h>
#include <impactdic/track.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "host/report/csv.h"
#include "host/video/frame_sink.h"
#include "tests/support/program.h"
#include "tests/support/rendered_clip.h"
#include "tests/support/warnings.h"

namespace impactdic::testing {
namespace {

constexpr double kRadius = 50, kTurn = 0.8;  // px, degrees a frame
constexpr double kStepX = 1.3, kStepY = 0.4;

BallPose pose_at(double frame) {
  return {70.3 + kStepX * frame, 62.8 + kStepY * frame, kTurn * frame};
}

// The pictures of these places, in turn. `noise`: grey levels.
std::vector<Frame> film_at(const std::vector<BallPose>& poses, double noise, const char* pattern) {
  SynthScene scene;
  scene.width = 192;
  scene.height = 144;
  scene.noise_sigma = noise;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball(pattern, 3, kRadius), scene);
  std::vector<Frame> frames(poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    renderer.render(poses[k], static_cast<std::int64_t>(k), frames[k]);
  }
  return frames;
}

// The same at each moment, in frame steps.
std::vector<Frame> film(const std::vector<double>& moments, double noise = 2,
                        const char* pattern = "e1") {
  std::vector<BallPose> poses;
  for (const double moment : moments) poses.push_back(pose_at(moment));
  return film_at(poses, noise, pattern);
}

std::vector<double> evenly(int count) {
  std::vector<double> moments;
  for (int k = 0; k < count; ++k) moments.push_back(k);
  return moments;
}

TrackResult track_film(std::vector<Frame> frames, std::int64_t step = 1) {
  static Session session;
  TrackRequest request;
  request.frames.step = step;
  request.clip.source = std::make_shared<MemoryClip>(std::move(frames));
  request.clip.fps = 10000;
  return track(request, session);
}

// Rows whose status is ok are right; `repeated` and those that lead to them say so, and are empty.
void expect_left_out(const TrackResult& result, const std::set<std::size_t>& repeated) {
  for (std::size_t i = 0; i + 1 < result.rows.size(); ++i) {
    const TrackRow& row = result.rows[i];
    const bool is_one = repeated.contains(i), leads_to_one = repeated.contains(i + 1);
    if (is_one || leads_to_one) {
      EXPECT_EQ(row.status, TrackStatus::kRepeated) << i;
      EXPECT_FALSE(row.motion_ok || std::isfinite(row.dx_px) || std::isfinite(row.rot_deg)) << i;
      EXPECT_EQ(row.circle_ok, !is_one) << i;
      EXPECT_EQ(std::isfinite(row.cx_px), !is_one) << i;
      EXPECT_EQ(row.pose.ok, !is_one) << i;
      continue;
    }
    EXPECT_EQ(row.status, TrackStatus::kOk) << i;
    EXPECT_NEAR(row.dx_px, kStepX, 5 * row.dx_sd_px) << i;
    EXPECT_NEAR(row.rot_deg, kTurn, 5 * row.rot_sd_deg) << i;
    EXPECT_NEAR(row.cx_px, pose_at(static_cast<double>(i)).cx_px, 5 * row.cx_sd_px) << i;
  }
}

void expect_flight(const TrackResult& result) {
  const FlightMotion& flight = result.impact.flight;
  ASSERT_GT(flight.last, flight.first);
  EXPECT_NEAR(flight.vx.value, kStepX, 4 * flight.vx.sd);
  EXPECT_NEAR(flight.spin.value, kTurn * kRadPerDeg, 4 * flight.spin.sd);
  EXPECT_LT(flight.vx.sd, 0.002);
}

TEST(OddFilm, FramesThatComeTwiceAreLeftOut) {
  std::vector<Frame> frames = film(evenly(30));
  for (const std::size_t k : {5, 12, 13, 29}) frames[k] = frames[k - 1];
  const TrackResult result = track_film(std::move(frames));
  expect_left_out(result, {5, 12, 13, 29});
  EXPECT_EQ(result.rows.back().status, TrackStatus::kRepeated);
  expect_flight(result);
  EXPECT_TRUE(says(
      result,
      "4 frames show the picture before them, or a part of it, once more, the first is frame 5"));
  EXPECT_FALSE(says(result, "put in"));
}

// The lower part of the ball is that of the frame before.
TEST(OddFilm, TornFramesAreLeftOut) {
  std::vector<Frame> frames = film(evenly(30));
  const std::vector<Frame> whole = frames;
  int row = 52;
  for (const std::size_t k : {4, 11, 19, 26}) {
    std::copy(whole[k - 1].u8.row(row), whole[k - 1].u8.row(0) + whole[k - 1].u8.size(),
              frames[k].u8.row(row));
    row += 8;
  }
  const TrackResult result = track_film(std::move(frames));
  expect_left_out(result, {4, 11, 19, 26});
  expect_flight(result);
}

// A coder gives the same picture other small errors.
TEST(OddFilm, ACoderMayHaveChangedThem) {
  std::vector<Frame> frames = film(evenly(24));
  std::mt19937 random(5);
  for (const std::size_t k : {6, 15, 23}) {
    frames[k] = frames[k - 1];
    for (int i = 0; i < 3000; ++i) frames[k].u8.data()[random() % frames[k].u8.size()] += 1;
  }
  const TrackResult result = track_film(std::move(frames));
  expect_left_out(result, {6, 15, 23});
  expect_flight(result);
}

TEST(OddFilm, FramesThatAConverterPutIn) {
  std::vector<double> moments;
  for (int k = 0; k < 30; ++k) moments.push_back(k - k / 5);
  std::vector<Frame> frames = film(moments);
  for (std::size_t k = 5; k < frames.size(); k += 5) frames[k] = frames[k - 1];
  const TrackResult result = track_film(std::move(frames));
  EXPECT_TRUE(says(result, "5 frames show the picture"));
  EXPECT_TRUE(says(result, "they were put in"));
}

// Where nothing moves a coder makes the same pictures, and so does a scene without noise.
TEST(OddFilm, ABallAtRestIsNoRepeatedFrame) {
  const TrackResult result = track_film(film(std::vector<double>(12, 3.0), 0));
  for (const TrackRow& row : result.rows) EXPECT_NE(row.status, TrackStatus::kRepeated);
  EXPECT_FALSE(says(result, "once more"));
}

TEST(OddFilm, FramesThatAreMissingAreNamed) {
  std::vector<double> moments = evenly(24);
  for (std::size_t k = 10; k < moments.size(); ++k) moments[k] += 2;
  const TrackResult result = track_film(film(moments));
  EXPECT_TRUE(says(result, "behind frame 9: 2 frames are missing there"));
  EXPECT_EQ(result.rows[9].periods, 3);
  EXPECT_DOUBLE_EQ(result.rows[9].time_s, 9e-4);
  EXPECT_DOUBLE_EQ(result.rows[10].time_s, 12e-4);
  expect_flight(result);
  EXPECT_FALSE(says(track_film(film(evenly(24))), "missing"));
}

// What moves evenly and is hit within a frame's time has no step that is a multiple of those
// beside it.
TEST(OddFilm, AnImpactIsNoGap) {
  std::vector<double> moments;
  for (int k = 0; k < 24; ++k) moments.push_back(k < 12 ? 2 * k : 24 + 0.7 * (k - 12));
  EXPECT_FALSE(says(track_film(film(moments)), "missing"));
}

// Film for screens: light to the power of 1 / 2.2. The rim seems to lie elsewhere by many of its
// deviations, and does not once the grey levels are light again.
TEST(OddFilm, CodedGreyLevelsAreTurnedBackToLight) {
  std::vector<Frame> frames = film(evenly(16), 0);
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0, 1.5);
  for (Frame& frame : frames) {
    for (std::size_t i = 0; i < frame.u8.size(); ++i) {
      const double coded = 255 * std::pow(frame.u8.data()[i] / 255.0, 1 / 2.2) + noise(random);
      frame.u8.data()[i] = static_cast<std::uint8_t>(std::clamp(std::lround(coded), 0L, 255L));
    }
  }
  ScratchFolder folder;
  const std::string clip = (folder / "film.tif").string();
  ClipInfo info = MemoryClip(frames).info();
  const auto sink = video::open_sink(clip, video::SinkFormat::kTiff, info);
  for (const Frame& frame : frames) sink->write(frame);
  sink->finish();
  Session session;
  const auto radius_off = [&](double gamma, double& sd_px) {
    TrackRequest request;
    request.clip.paths = {clip};
    request.clip.open.gamma = gamma;
    const TrackResult result = track(request, session);
    EXPECT_EQ(result.frames_ok, 16);
    double sum = 0;
    for (const TrackRow& row : result.rows) {
      sum += row.r_px - kRadius;
      sd_px = row.r_sd_px;
    }
    return sum / static_cast<double>(result.rows.size());
  };
  double sd_px = 0;
  EXPECT_GT(radius_off(0, sd_px), 0.1);
  EXPECT_GT(radius_off(1, sd_px), 0.1);
  EXPECT_NEAR(radius_off(2.2, sd_px), 0, std::max(0.02, 3 * sd_px));
}

// A scale by the ball's diameter holds what nobody knows of a film's grey levels.
TEST(OddFilm, AScaleHoldsWhatCodedFilmHides) {
  ScratchFolder folder;
  const Outcome made = run_program(
      "synth --size 192x144 --radius-px 50 --frames 16 --velocity-px 1.3,0.4 --noise 2 --format "
      "mp4 -q -o " +
      quoted(folder / "made"));
  if (made.status != 0) GTEST_SKIP() << "this build writes no film: " << made.err;
  Session session;
  const auto scale_sd = [&](double gamma, bool& warned) {
    TrackRequest request;
    request.clip.paths = {(folder / "made/video.mp4").string()};
    request.clip.open.gamma = gamma;
    request.clip.fps = 1000;
    request.ball_diameter_mm = 40;
    const TrackResult result = track(request, session);
    warned = says(result, "--gamma");
    return result.scale.metre_per_px_sd / result.scale.metre_per_px;
  };
  bool warned = false;
  EXPECT_GT(scale_sd(0, warned), 0.35 / kRadius);
  EXPECT_TRUE(warned);
  EXPECT_LT(scale_sd(1, warned), 0.1 / kRadius);
  EXPECT_FALSE(warned);
}

// Of a colour camera, or one that smooths its pictures.
TEST(OddFilm, NoiseOfPixelsThatTouchIsNoTexture) {
  std::vector<Frame> frames = film(evenly(12), 0);
  std::mt19937 random(11);
  std::normal_distribution<float> normal(0, 1);
  for (Frame& frame : frames) {
    const int width = frame.width(), height = frame.height();
    Image<float> noise(width + 2, height + 2);
    for (std::size_t i = 0; i < noise.size(); ++i) noise.data()[i] = 4 * normal(random);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        float sum = 0;
        for (int k = 0; k < 9; ++k) sum += noise(x + k % 3, y + k / 3);
        const float level = static_cast<float>(frame.u8(x, y)) + sum / 5;
        frame.u8(x, y) = static_cast<std::uint8_t>(std::clamp(level + 0.5f, 0.0f, 255.0f));
      }
    }
  }
  EXPECT_FALSE(says(track_film(std::move(frames)), "from side to side"));
}

// Wires before the ball hold every step back by less than the pictures' noise shows; the flight,
// whose places are told by keyframes, shows it.
TEST(OddFilm, StepsStateWhatTheFlightShowsThemToErrBy) {
  std::vector<Frame> frames = film(evenly(40), 0, "c3");
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 1.5);
  for (Frame& frame : frames) {
    for (int y = 0; y < frame.height(); ++y) {
      for (int x = 0; x < frame.width(); ++x) {
        const double level = (x % 30 < 2 || y % 30 < 2 ? 120.0 : frame.u8(x, y)) + noise(random);
        frame.u8(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
      }
    }
  }
  const TrackResult result = track_film(frames);
  EXPECT_TRUE(says(result, "motions scatter by more"));
  double squares = 0, count = 0;
  for (const TrackRow& row : result.rows) {
    if (row.status != TrackStatus::kOk) continue;
    squares += std::pow((row.dx_px - kStepX) / row.dx_sd_px, 2), ++count;
    squares += std::pow((row.dy_px - kStepY) / row.dy_sd_px, 2), ++count;
  }
  EXPECT_GT(count, 60);
  EXPECT_LT(std::sqrt(squares / count), 1.5);
  EXPECT_GT(std::sqrt(squares / count), 0.6);

  // In files as in memory.
  ScratchFolder folder;
  Session session;
  TrackRequest request;
  request.clip.source = std::make_shared<MemoryClip>(std::move(frames));
  request.clip.fps = 10000;
  track_to_folder(request, {.folder = (folder / "track").string()}, session);
  const std::vector<TrackRow> written = report::read_track_csv(folder / "track/track.csv");
  ASSERT_EQ(written.size(), result.rows.size());
  for (std::size_t i = 0; i + 1 < written.size(); ++i) {
    EXPECT_EQ(written[i].rot_sd_deg, result.rows[i].rot_sd_deg) << i;
    EXPECT_EQ(written[i].dx_sd_px, result.rows[i].dx_sd_px) << i;
  }
}

TEST(OddFilm, StepsOfAnEvenFilmStateWhatTheyErrBy) {
  EXPECT_FALSE(says(track_film(film(evenly(40))), "motions scatter"));
}

// Gravity bends the path: a motion is that half a step behind its frame, however long a step is.
TEST(OddFilm, StepsOfAThrownBallStateWhatTheyErrBy) {
  std::vector<BallPose> poses;
  for (int k = 0; k < 40; ++k) {
    poses.push_back({65 + 1.5 * k, 85 - 1.6 * k + 0.045 * k * k, kTurn * k});
  }
  const std::vector<Frame> frames = film_at(poses, 2, "d1");
  for (const std::int64_t step : {1, 2}) {
    const TrackResult result = track_film(frames, step);
    EXPECT_GT(result.impact.flight.last, 0u);
    EXPECT_FALSE(says(result, "motions scatter")) << step;
  }
}

// The ball lags behind by 0.4 of its steps where three tenths of each picture are the one before.
TEST(OddFilm, PicturesThatHoldThoseBeforeThemAreNamed) {
  const auto remembers = [](double share) {
    std::vector<Frame> frames = film(evenly(24));
    std::vector<double> shown(frames[0].u8.size());
    for (Frame& frame : frames) {
      const bool first = &frame == &frames[0];
      for (std::size_t i = 0; i < shown.size(); ++i) {
        const double level = frame.u8.data()[i];
        shown[i] = first ? level : std::lerp(level, shown[i], share);
        frame.u8.data()[i] = static_cast<std::uint8_t>(std::lround(shown[i]));
      }
    }
    return says(track_film(std::move(frames)), "of each picture is that of the one before");
  };
  EXPECT_TRUE(remembers(0.3));
  EXPECT_TRUE(remembers(0.2));
  EXPECT_FALSE(remembers(0));
}

}  // namespace
}  // namespace impactdic::testing
