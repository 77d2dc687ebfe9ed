// A run that was interrupted anywhere goes on to the same rows, poses and fields, to the last bit.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <array>
#include <bit>
#include <limits>

#include "host/report/csv.h"
#include "host/report/resume_file.h"
#include "tests/support/rendered_clip.h"
#include "tests/support/scratch.h"
#include "tests/support/speckle_frames.h"

namespace impactdic::testing {
namespace {

// The ball is lost for two frames, its ink changes, and it is hit on the way.
MemoryClip eventful_clip() {
  SynthScene scene;
  scene.width = scene.height = 128;
  scene.noise_sigma = 2;
  sim::speckle::SpeckleBall ball = quick_ball(3, 40);
  const sim::speckle::SpeckleBall fresh = quick_ball(4, 40);
  std::vector<Frame> frames(44);
  std::size_t next = 0;
  double x = 52, y = 50, angle = 11;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    sim::speckle::BallRenderer(ball, scene)
        .render(pose(x, y, angle), static_cast<std::int64_t>(k), frames[k]);
    for (int n = 0; n < 3; ++n, ++next) {
      ball.discs[next % ball.discs.size()] = fresh.discs[next % fresh.discs.size()];
    }
    x += 0.4;
    y += k < 28 ? 0.6 : -0.5;
    angle += k < 28 ? 1.3 : 3.1;
  }
  for (const std::size_t k : {17, 18}) {
    std::fill_n(frames[k].u8.data(), frames[k].u8.size(), std::uint8_t{30});
  }
  return MemoryClip(std::move(frames));
}

struct Outcome {
  std::vector<std::string> rows;  // with pose and field: equal texts are equal bits
  std::vector<pipeline::ResumePoint> points;
};

std::string bits(const pipeline::TrackedFrame& frame) {
  const BodyPose& p = frame.row.pose;
  std::string text = report::track_csv_line(frame.row, {});
  for (const double value : {p.x_px, p.y_px, p.angle_rad, p.x_sd_px, p.y_sd_px, p.angle_sd_rad}) {
    text += " " + std::to_string(std::bit_cast<std::uint64_t>(value));
  }
  text += " " + std::to_string(p.origin) + " " + std::to_string(p.keyframe);
  if (frame.pair == nullptr) return text;
  for (std::size_t i = 0; i < frame.pair->field.size(); ++i) {
    const WindowMotion& m = frame.pair->field[i];
    for (const float value : {m.u, m.v, m.u_sd, m.v_sd, m.correlation, m.ux, m.uy, m.vx, m.vy}) {
      text += " " + std::to_string(std::bit_cast<std::uint32_t>(value));
    }
    text += " " + std::to_string(frame.pair->windows[i].x0) + " " + std::to_string(m.status);
  }
  return text;
}

Outcome run(FrameSource& clip, Estimator estimator, int batch,
            const std::optional<pipeline::ResumePoint>& from, int poses_ahead = 0,
            const std::vector<BallByHand>& by_hand = {}, bool circles_on_device = false) {
  pipeline::TrackOptions options;
  options.circles_on_device = circles_on_device;
  options.poses_ahead = poses_ahead;
  options.estimator.estimator = estimator;
  options.frames = {0, clip.info().frame_count, 1};
  options.roi = {4, 2, clip.info().width - 4, clip.info().height - 2};
  options.batch = batch;
  options.ball.by_hand = by_hand;
  options.from = from;
  Outcome outcome;
  options.checkpoint = [&](const pipeline::ResumePoint& point) {
    outcome.points.push_back(point);
    const std::size_t before = from ? static_cast<std::size_t>(from->next_row) : 0;
    EXPECT_EQ(before + outcome.rows.size(), static_cast<std::size_t>(point.next_row));
  };
  opencl::Engine* const engines[] = {&shared_engine()};
  pipeline::track_clip(
      clip, engines, options, [](std::span<const Window>, double) {},
      [&](const pipeline::TrackedFrame& frame) { outcome.rows.push_back(bits(frame)); },
      [](std::int64_t, std::int64_t) {});
  return outcome;
}

class Resume : public ::testing::TestWithParam<std::tuple<Estimator, int>> {};

TEST_P(Resume, GoesOnToTheSameBits) {
  const auto [estimator, batch] = GetParam();
  const ScratchFolder folder;
  MemoryClip clip = eventful_clip();
  const Outcome whole = run(clip, estimator, batch, std::nullopt);
  ASSERT_EQ(whole.rows.size(), 44u);
  ASSERT_EQ(whole.points.size(), static_cast<std::size_t>(43 / batch));
  // The loss, the hit and many a keyframe lie between these.
  for (std::size_t k = 0; k < whole.points.size(); k += batch < 8 ? 3 : 1) {
    const pipeline::ResumePoint& point = whole.points[k];
    report::write_resume_point(folder / "resume.json", point);
    const Outcome rest =
        run(clip, estimator, batch, report::read_resume_point(folder / "resume.json"));
    const auto first = static_cast<std::size_t>(point.next_row);
    ASSERT_EQ(first + rest.rows.size(), whole.rows.size());
    for (std::size_t i = first; i < whole.rows.size(); ++i) {
      ASSERT_EQ(rest.rows[i - first], whole.rows[i]) << "row " << i << " from row " << first;
    }
  }
}

// Points lie between groups of batches whose frames are registered together.
TEST(Resume, GoesOnToTheSameBitsWherePosesAreRegisteredAhead) {
  const ScratchFolder folder;
  MemoryClip clip = eventful_clip();
  const Outcome whole = run(clip, Estimator::kBall, 5, std::nullopt, 2);
  ASSERT_EQ(whole.rows.size(), 44u);
  ASSERT_EQ(whole.points.size(), 4u);
  const pipeline::ResumePoint& point = whole.points[1];
  EXPECT_EQ(point.next_row, 19);
  report::write_resume_point(folder / "resume.json", point);
  const Outcome rest =
      run(clip, Estimator::kBall, 5, report::read_resume_point(folder / "resume.json"), 2);
  for (std::size_t i = 19; i < whole.rows.size(); ++i) {
    ASSERT_EQ(rest.rows.at(i - 19), whole.rows[i]) << "row " << i;
  }
}

TEST(Resume, GoesOnToTheSameBitsWhereTheDeviceFollowsCircles) {
  const ScratchFolder folder;
  MemoryClip clip = eventful_clip();
  const auto from = [&](const std::optional<pipeline::ResumePoint>& point) {
    return run(clip, Estimator::kBall, 10, point, 0, {}, true);
  };
  const Outcome whole = from(std::nullopt);
  EXPECT_NE(whole.rows, run(clip, Estimator::kBall, 10, std::nullopt).rows);  // it has had a part
  for (const pipeline::ResumePoint& point : whole.points) {
    report::write_resume_point(folder / "resume.json", point);
    const Outcome rest = from(report::read_resume_point(folder / "resume.json"));
    const auto first = static_cast<std::size_t>(point.next_row);
    for (std::size_t i = first; i < whole.rows.size(); ++i) {
      ASSERT_EQ(rest.rows.at(i - first), whole.rows[i]) << "row " << i << " from row " << first;
    }
  }
}

// A frame corrected by hand changes no row before the batch that it stands in.
TEST(Resume, GoesBackToBeforeACorrectedFrame) {
  MemoryClip clip = eventful_clip();
  const std::vector<BallByHand> by_hand = {{33, 0, 0, 0}, {36, 60, 55, 41}};
  const Outcome plain = run(clip, Estimator::kBall, 16, std::nullopt);
  const Outcome whole = run(clip, Estimator::kBall, 16, std::nullopt, 0, by_hand);
  ASSERT_EQ(plain.points.size(), 2u);
  ASSERT_EQ(plain.points[1].next_row, 31);
  for (std::size_t i = 0; i < 31; ++i) ASSERT_EQ(plain.rows[i], whole.rows[i]) << "row " << i;
  EXPECT_NE(plain.rows[33], whole.rows[33]);
  const Outcome rest = run(clip, Estimator::kBall, 16, plain.points[1], 0, by_hand);
  ASSERT_EQ(31 + rest.rows.size(), whole.rows.size());
  for (std::size_t i = 31; i < whole.rows.size(); ++i) {
    ASSERT_EQ(rest.rows[i - 31], whole.rows[i]) << "row " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Batches, Resume,
                         ::testing::Combine(::testing::Values(Estimator::kField, Estimator::kBall),
                                            ::testing::Values(5, 16)));

TEST(ResumeFile, KeepsEveryFigureOfACircle) {
  const ScratchFolder folder;
  pipeline::ResumePoint point;
  point.next_row = 7;
  circle::CircleFit& fit = point.circle;
  double value = 0.1;
  const auto figures = [](circle::CircleFit& f) {
    return std::array{&f.circle.cx_px, &f.circle.cy_px, &f.circle.r_px, &f.circle.free_px,
                      &f.cx_sd_px,     &f.cy_sd_px,     &f.r_sd_px,     &f.e1_px,
                      &f.e2_px,        &f.e1_sd_px,     &f.e2_sd_px,    &f.residual_px,
                      &f.rim_fraction};
  };
  for (double* figure : figures(fit)) *figure = value *= 1.7;
  fit.circle.free_px = std::numeric_limits<double>::infinity();
  fit.status = circle::CircleStatus::kOutOfView;
  fit.ellipse = fit.inked = true;
  fit.bright = false;
  fit.rim_points = 123;
  circle::RimBias& bias = point.tracker.rim_bias.emplace();
  bias.off_px = -0.1 / 3, bias.shared_sd_px = 0.1 / 7, bias.chance_sd_px = 0.1 / 9, bias.lit = true;
  report::write_resume_point(folder / "resume.json", point);
  pipeline::ResumePoint back = report::read_resume_point(folder / "resume.json");
  for (std::size_t i = 0; i < figures(fit).size(); ++i) {
    EXPECT_EQ(*figures(back.circle)[i], *figures(fit)[i]) << i;
  }
  EXPECT_EQ(back.circle.status, fit.status);
  EXPECT_TRUE(back.circle.ellipse && back.circle.inked && !back.circle.bright);
  EXPECT_EQ(back.circle.rim_points, 123);
  ASSERT_TRUE(back.tracker.rim_bias);
  EXPECT_EQ(back.tracker.rim_bias->numbers(), bias.numbers());
  EXPECT_FALSE(back.grid_radius_px || back.keyframes);
}

TEST(ResumeFile, KeepsEveryFigureOfPoses) {
  const ScratchFolder folder;
  pipeline::ResumePoint point;
  point.next_row = 7;
  BodyPose& pose = point.keyframes.emplace().last;
  double value = 0.1;
  const auto figures = [](BodyPose& p) {
    return std::array{&p.x_px,         &p.y_px,          &p.x_sd_px,       &p.y_sd_px,
                      &p.angle_sd_rad, &p.tilt_x_sd_rad, &p.tilt_y_sd_rad, &p.key_dx_px,
                      &p.key_dy_px,    &p.key_rot_x_deg, &p.key_rot_y_deg, &p.key_rot_deg};
  };
  for (double* figure : figures(pose)) *figure = value *= 1.7;
  pose.ok = true;
  pose.qw = 0.5, pose.qx = -0.5, pose.qy = 0.5, pose.qz = 0.5;
  pose.origin = 2, pose.keyframe = 5;
  for (const double e1 : {0.0, -0.06}) {  // round, and in contact
    motion::Keyframe& key = point.keyframes->keyframes.emplace_back();
    key.pose.ok = true;
    key.pose.x_px = key.pose.y_px = key.pose.angle_rad = 0;
    key.pose.origin = key.pose.keyframe = 0;
    key.circle = {1, 2, 3};
    if (e1 != 0) key.shape = {e1, 0.04, 0.001};
  }
  report::write_resume_point(folder / "resume.json", point);
  pipeline::ResumePoint back = report::read_resume_point(folder / "resume.json");
  ASSERT_TRUE(back.keyframes);
  for (std::size_t i = 0; i < figures(pose).size(); ++i) {
    EXPECT_EQ(*figures(back.keyframes->last)[i], *figures(pose)[i]) << i;
  }
  EXPECT_EQ(back.keyframes->last.qx, -0.5);
  EXPECT_EQ(back.keyframes->last.keyframe, 5);
  EXPECT_EQ(back.keyframes->keyframes[0].shape.e1, 0);
  const motion::BallShape& shape = back.keyframes->keyframes[1].shape;
  EXPECT_TRUE(shape.e1 == -0.06 && shape.e2 == 0.04 && shape.sd == 0.001);
}

TEST(ResumeFile, DamageIsRefused) {
  const ScratchFolder folder;
  EXPECT_THROW(report::read_resume_point(folder / "resume.json"), FileError);
  std::ofstream(folder / "resume.json") << R"({"next_row": 3, "circle": {)";
  EXPECT_THROW(report::read_resume_point(folder / "resume.json"), FormatError);
}

// Another clip than the earlier run's, or a part of it.
TEST(ResumeFile, APointBeyondTheClipIsRefused) {
  MemoryClip clip = eventful_clip();
  pipeline::ResumePoint point;
  point.next_row = 43;
  EXPECT_THROW(run(clip, Estimator::kField, 8, point), InvalidArgument);
}

}  // namespace
}  // namespace impactdic::testing
