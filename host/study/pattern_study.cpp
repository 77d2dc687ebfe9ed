#include "host/study/pattern_study.h"

#include <impactdic/error.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "host/circle/ball_tracker.h"
#include "host/dic/device/ball.h"
#include "host/dic/error_bound.h"
#include "host/dic/frames/device_frames.h"
#include "host/study/motion_errors.h"
#include "sim/speckle/render.h"

namespace impactdic::study {
namespace {

// Of a picture with noise `sigma`: rounding to whole grey levels adds its own.
double with_rounding(double sigma) { return std::sqrt(sigma * sigma + 1.0 / 12); }

Image<float> to_float(const Image<double>& picture) {
  Image<float> out(picture.width(), picture.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.data()[i] = static_cast<float>(picture.data()[i]);
  }
  return out;
}

// One clip: frames, what is true of them, what the circle fit says.
struct Clip {
  StudyMotion motion;
  std::vector<BallPose> poses;
  std::vector<Frame> frames;
  std::vector<circle::CircleFit> circles;
  ErrorSums centre_px;
  std::vector<dic::PictureSlopes> slopes;  // of the frames without noise, but for the last
  BallBound bound;                         // of the first pair
};

class PatternStudy {
 public:
  PatternStudy(opencl::Engine& engine, const PatternStudyRequest& options)
      : options_(options), frames_(engine, options.pairs + 1) {
    for (const std::string& name : options.estimators) {
      estimators_.push_back(parse_study_estimator(name));
      estimators_.back().options.field.noise = options.noise;
      runs_.push_back(motion::make_motion_estimator(engine, estimators_.back().options,
                                                    options.radius_px, frames_));
    }
  }

  void run(const sim::speckle::PatternSpec& pattern, const sim::speckle::BallRenderer& renderer,
           const StudyMotion& motion, std::vector<PatternStudyRow>& rows) {
    const Clip clip = make_clip(renderer, motion);
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      PatternStudyRow row;
      row.pattern = pattern.name;
      row.density = pattern.density;
      row.motion = motion;
      row.centre_px = clip.centre_px;
      row.bound_dx_px = clip.bound.dx_sd_px;
      row.bound_dy_px = clip.bound.dy_sd_px;
      row.bound_rot_deg = clip.bound.rot_sd_rad * kDegPerRad;
      row.estimator = estimators_[k].name;
      // The first clip of all compiles and allocates: it is measured twice.
      if (rows.size() < runs_.size()) measure(estimators_[k], *runs_[k], clip);
      row.errors = measure(estimators_[k], *runs_[k], clip);
      rows.push_back(std::move(row));
    }
  }

 private:
  Clip make_clip(const sim::speckle::BallRenderer& renderer, const StudyMotion& motion) const {
    Clip clip;
    clip.motion = motion;
    const double middle = (renderer.scene().width - 1) / 2.0;
    ConstantMotion constant;
    // Off the grid of pixels, and the clip about the picture's middle.
    constant.start.cx_px = middle + 0.3 - motion.dx_px * options_.pairs / 2.0;
    constant.start.cy_px = middle - 0.4 - motion.dy_px * options_.pairs / 2.0;
    constant.start.angle_deg = 7;
    constant.dx_px = motion.dx_px;
    constant.dy_px = motion.dy_px;
    constant.rotation_deg = motion.rot_deg;
    clip.poses = sim::speckle::constant_motion(constant, options_.pairs + 1);
    circle::BallTracker tracker;
    const double noise = with_rounding(options_.noise);
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      const BallPose& pose = clip.poses[k];
      clip.frames.emplace_back();
      renderer.render(pose, static_cast<std::int64_t>(k), clip.frames.back());
      clip.circles.push_back(tracker.track(clip.frames.back(), static_cast<std::int64_t>(k)));
      if (clip.circles.back().status == circle::CircleStatus::kOk) {
        clip.centre_px.add(clip.circles.back().circle.cx_px - pose.cx_px);
        clip.centre_px.add(clip.circles.back().circle.cy_px - pose.cy_px);
      }
      if (k + 1 == clip.poses.size()) break;
      clip.slopes.emplace_back(to_float(renderer.exact(pose)).view(), 0.0);
      if (k == 0) {
        clip.bound = clip.slopes[0].disc(pose.cx_px, pose.cy_px,
                                         options_.radius_px - dic::kRimMarginPx, noise);
      }
    }
    return clip;
  }

  // The time holds all that a clip costs: frames to the device, their splines, both batches.
  MotionErrors measure(const StudyEstimator& estimator, motion::MotionEstimator& run,
                       const Clip& clip) {
    MotionErrors errors;
    std::vector<motion::PairMotion> pairs;
    std::vector<std::size_t> first;  // frame of each pair
    for (std::size_t k = 0; k + 1 < clip.frames.size(); ++k) {
      const circle::CircleFit &a = clip.circles[k], &b = clip.circles[k + 1];
      if (a.status != circle::CircleStatus::kOk || b.status != circle::CircleStatus::kOk) {
        ++errors.pairs;
        ++errors.failed_pairs;
        continue;
      }
      motion::PairMotion pair;
      pair.first_slot = static_cast<int>(k);
      pair.second_slot = static_cast<int>(k) + 1;
      pair.first = a.circle;
      pair.second = estimator.aimed ? b.circle : a.circle;
      pairs.push_back(pair);
      first.push_back(k);
    }
    if (pairs.empty()) return errors;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < clip.frames.size(); ++k) {
      frames_.set(static_cast<int>(k), clip.frames[k]);
    }
    run.measure({pairs.data(), 1});
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      if (estimator.aimed && pairs[0].motion.ok) pairs[i].guess_rot_rad = pairs[0].motion.rot_rad;
    }
    run.measure({pairs.data() + 1, pairs.size() - 1});
    errors.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const BallPose& pose = clip.poses[first[i]];
      add_pair(pairs[i], {pose.cx_px, pose.cy_px, clip.motion}, estimator.options.field.window_px,
               clip.slopes[first[i]], with_rounding(options_.noise), errors);
    }
    return errors;
  }

  const PatternStudyRequest& options_;
  dic::DeviceFrames frames_;
  std::vector<StudyEstimator> estimators_;
  std::vector<std::unique_ptr<motion::MotionEstimator>> runs_;
};

}  // namespace

std::vector<PatternStudyRow> run_pattern_study(opencl::Engine& engine,
                                               const PatternStudyRequest& options,
                                               const RunControl& control) {
  std::vector<const sim::speckle::PatternSpec*> patterns;
  for (const sim::speckle::PatternSpec& spec : sim::speckle::pattern_specs()) {
    const bool all = options.patterns.empty();
    if (all || std::find(options.patterns.begin(), options.patterns.end(), spec.name) !=
                   options.patterns.end()) {
      patterns.push_back(&spec);
    }
  }
  SynthScene scene;
  constexpr double kMarginPx = 16;  // about the ball: its way, and background for the circle
  const double travel = 2.0 * options.pairs;
  scene.width = scene.height =
      static_cast<int>(std::ceil(2 * (options.radius_px + kMarginPx) + travel));
  scene.noise_sigma = options.noise;
  PatternStudy study(engine, options);
  std::vector<PatternStudyRow> rows;
  const auto total = static_cast<std::int64_t>(patterns.size() * study_motions().size());
  std::int64_t done = 0;
  for (const sim::speckle::PatternSpec* pattern : patterns) {
    const sim::speckle::SpeckleBall ball =
        sim::speckle::paint_ball(pattern->name, options.seed, options.radius_px);
    for (const StudyMotion& motion : study_motions()) {
      if (control.is_cancelled()) return rows;
      // Noise of its own for every clip.
      scene.noise_seed = options.seed * 1000 + static_cast<std::uint64_t>(done);
      study.run(*pattern, sim::speckle::BallRenderer(ball, scene), motion, rows);
      ++done;
      if (control.progress) control.progress({"study", done, total});
    }
  }
  return rows;
}

}  // namespace impactdic::study
