#include "host/advice/body_advice.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "host/advice/slow_tilt.h"
#include "host/advice/turned_paint.h"
#include "host/base/statistics.h"
#include "host/base/weighted_mean.h"
#include "host/dic/device/ball.h"
#include "host/dic/frame_noise.h"
#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_fit.h"
#include "host/motion/estimators.h"
#include "host/sphere/picture_blur.h"

namespace impactdic::advice {
namespace {

// Chance: squares of two deviates together pass this once in three million.
constexpr double kSignificant = 30;
// A smaller turn moves no point of the picture by as much as matters.
constexpr double kSmallest_px = 0.03;

// Where the windows lie flat within this, the pair is not registered as a sphere at all.
constexpr double kFlat = 12;
constexpr double kAgreeing = 0.5;  // share of the windows that must say so

// What a ball's rim says of a sphere's radius may be off by this, the same in every frame: the
// texture is foreshortened there and its light another.
constexpr double kRimRadiusSd_px = 0.5;
// Of all that turns show of the radius, and of it over the distance: one texture's errors are alike
// in every pair.
constexpr double kTurnRadiusSd_px = 0.015, kNearnessSd = 4e-4;

// Radii by turns that scatter by more than so often what they state are those of a ball that comes
// nearer, or wrong.
constexpr double kAlikeRadii = 2;

// A ball's outline does not change by as much from frame to frame, but in contact and where it is
// not a sphere's: a fruit that turns.
constexpr double kOutOfRound = 0.02;

constexpr const char* kUnmeasured = "no pair of frames could be measured as a sphere";

struct Tilt {
  bool is_known = true;  // else the pair could be measured as a flat ball's alone
  double turn_deg = 0;
  double beyond_chance = 0;  // chi square of two degrees of freedom
  bool is_out_of_plane = false;
  double radius_px = 0, radius_sd_px = 0;  // that the motion shows
  dic::RigidMotion motion;                 // of the sphere; not ok where it was not registered
};

class PairLook {
 public:
  PairLook(opencl::Engine& engine, const BallPair& pair, const motion::EstimatorOptions& known)
      : engine_(engine), pair_(pair), known_(known), frames_(engine, 2) {
    frames_.set(0, pair.first);
    frames_.set(1, pair.second);
  }

  dic::RigidMotion flat_motion() { return measured(false).motion; }

  // nullopt where the pair shows no motion of a sphere.
  std::optional<Tilt> tilt() {
    const motion::PairMotion flat = measured(false);
    if (Tilt of_windows = windows_tilt(flat); of_windows.beyond_chance < kFlat) {
      of_windows.motion = flat.motion;
      return of_windows;
    }
    const motion::PairMotion turned = measured(true);
    // A flat ball may be pressed; what a tilt does to a picture is even about its centre, which no
    // strain is.
    const auto disc = registered(flat, dic::BallModel::kAffine);
    const auto free = registered(turned, dic::BallModel::kSphereAndRadius);
    std::optional<Tilt> tilt;
    if (free) tilt = judged(*free, disc);
    if (!tilt || !tilt->is_out_of_plane) {
      // A small turn does not tell the radius, and tells less of itself where that is free.
      if (const auto known = registered(turned, dic::BallModel::kSphere)) {
        tilt = judged(*known, disc);
      }
    }
    if (!tilt && flat.motion.ok) {
      tilt.emplace();
      tilt->is_known = false;
      tilt->motion = flat.motion;
    }
    return tilt;
  }

 private:
  static Tilt tilt_of(double x_rad, double x_sd_rad, double y_rad, double y_sd_rad) {
    Tilt tilt;
    tilt.turn_deg = std::hypot(x_rad, y_rad) * kDegPerRad;
    tilt.beyond_chance = std::pow(x_rad / x_sd_rad, 2) + std::pow(y_rad / y_sd_rad, 2);
    return tilt;
  }

  // What the registration of a sphere says, beside that of a disc, if there is one.
  Tilt judged(const BallMotion& sphere, const std::optional<BallMotion>& disc) const {
    Tilt tilt = tilt_of(sphere.rot_x_rad, std::sqrt(sphere.covariance[5]), sphere.rot_y_rad,
                        std::sqrt(sphere.covariance[9]));
    const double moved_px = tilt.turn_deg * kRadPerDeg * pair_.first_ball.r_px;
    tilt.radius_px = sphere.ball_radius;
    tilt.radius_sd_px = sphere.ball_radius_sd;
    tilt.motion = motion::sphere_motion(sphere);
    tilt.is_out_of_plane = tilt.beyond_chance > kSignificant && moved_px > kSmallest_px &&
                           !(disc && sphere.residual >= disc->residual);
    return tilt;
  }

  // What the windows of a pair measured as a disc say; beyond all chance where they say nothing.
  Tilt windows_tilt(const motion::PairMotion& flat) const {
    dic::SphereGuess guess;
    guess.cx_px = pair_.first_ball.cx_px;
    guess.cy_px = pair_.first_ball.cy_px;
    guess.radius_px = pair_.first_ball.r_px;
    guess.dx_px = pair_.second_ball.cx_px - pair_.first_ball.cx_px;
    guess.dy_px = pair_.second_ball.cy_px - pair_.first_ball.cy_px;
    guess.shift_sd_px = 0.05;
    guess.turn = dic::quaternion_of({0, 0, flat.motion.rot_rad});
    const dic::SphereFit fit = dic::fit_sphere_motion(
        motion::field_points(flat.windows, flat.field, known_.field.window_px), guess);
    Tilt unknown;
    unknown.beyond_chance = std::numeric_limits<double>::infinity();
    if (!flat.motion.ok || !fit.ok || fit.share < kAgreeing) return unknown;
    // The pixels of a window are those of two a side.
    constexpr double kOverlap = 2;
    const Eigen::Vector3d turn = dic::rotation_vector(fit.turn);
    return tilt_of(turn.x(), kOverlap * fit.rot_x_sd_rad, turn.y(), kOverlap * fit.rot_y_sd_rad);
  }

  motion::PairMotion measured(bool sphere) {
    motion::EstimatorOptions options;
    options.estimator = Estimator::kBall;
    options.field = known_.field;
    options.moving = known_.moving;
    options.sphere = sphere;
    if (sphere) options.perspective = known_.perspective;
    motion::PairMotion pair;
    pair.second_slot = 1;
    pair.first = pair_.first_ball;
    pair.second = pair_.second_ball;
    if (sphere) {
      for (Circle* ball : {&pair.first, &pair.second}) {
        *ball = motion::about_centre(*ball, known_.perspective);
      }
    }
    motion::make_motion_estimator(engine_, options, pair_.first_ball.r_px, frames_)
        ->measure({&pair, 1});
    return pair;
  }

  // The whole ball once more, for what is left of the pictures.
  std::optional<BallMotion> registered(const motion::PairMotion& pair, dic::BallModel model) {
    if (!pair.motion.ok) return std::nullopt;
    BallTask task =
        motion::sphere_task(pair.first, pair.first.r_px, sphere::kUsualBlur_px2, pair.motion);
    task.second = 1;
    if (model != dic::BallModel::kAffine) {
      task.sight = motion::pair_sight(pair, known_.perspective, pair.first.r_px);
    }
    dic::BallRegistration registration(engine_, motion::ball_options(known_, model));
    const BallMotion motion = registration.measure(frames_, {&task, 1})[0];
    if (motion.status != static_cast<idic_int>(WindowStatus::kOk)) return std::nullopt;
    return motion;
  }

  opencl::Engine& engine_;
  const BallPair& pair_;
  const motion::EstimatorOptions& known_;
  dic::DeviceFrames frames_;
};

// How much the outline's radius usually changes from frame to frame, share of itself.
double out_of_round(std::span<const BallPair> pairs) {
  std::vector<double> changes;
  for (const BallPair& pair : pairs) {
    changes.push_back(std::abs(pair.second_ball.r_px / pair.first_ball.r_px - 1));
  }
  return changes.empty() ? 0 : upper_median(std::move(changes));
}

// Why no pair was measured as a sphere's.
std::string unmeasured(double out_of_round) {
  if (!(out_of_round > kOutOfRound)) return kUnmeasured;
  char text[120];
  std::snprintf(text, sizeof text,
                "no sphere: the radius of its outline changes by %.0f %% from frame to frame",
                100 * out_of_round);
  return text;
}

// What all pairs tell.
class Verdict {
 public:
  Verdict(opencl::Engine& engine, const motion::EstimatorOptions& known, const FarFrames& far)
      : engine_(engine), known_(known), far_(far) {}

  void look_at(const BallPair& pair) {
    const std::optional<Tilt> tilt = PairLook(engine_, pair, known_).tilt();
    if (!tilt) return;
    if (tilt->motion.ok) moved_.push_back({pair.index, pair.first_ball, tilt->motion});
    measured_ += tilt->is_known ? 1 : 0;
    radius_.add(pair.first_ball.r_px, kRimRadiusSd_px);
    const bool free = tilt->radius_sd_px > 0;
    if ((free || tilt->is_out_of_plane) && !learn_from(pair, tilt->motion) && free) {
      radius_.add(tilt->radius_px, tilt->radius_sd_px);
    }
    out_of_plane_ |= tilt->is_out_of_plane;
    if (by_turns_.count() == 0 && !(bare_light_.least > 0)) learn_from_paint(pair);
    if (!tilt->is_out_of_plane && tilt->motion.ok) flat_.emplace_back(&pair, tilt->motion);
    if (tilt->turn_deg < most_deg_) return;
    most_deg_ = tilt->turn_deg;
    significant_ = std::sqrt(tilt->beyond_chance);
  }

  // Whether a pair was measured as a sphere, or farther pictures may tell.
  bool is_measured() const { return measured_ > 0; }
  bool may_be_told() const { return !flat_.empty(); }

  BodyAdvice advice() {
    const std::string reason = decide();
    BodyAdvice advice;
    advice.body = out_of_plane_ ? Body::kSphere : Body::kDisc;
    advice.reason = reason;
    if (!out_of_plane_) advice.unseen_tilt_rad = unseen_tilt_rad();
    advice.radius_px = radius_.value();
    // Far pairs of a short clip share their pictures, and with them their noise.
    advice.radius_sd_px =
        std::max({radius_.sd(), by_turns_.count() > 0 ? best_radius_sd_px_ : 0, kTurnRadiusSd_px});
    if (by_turns_.count() > 1 && by_turns_.sd() < kAlikeRadii * std::sqrt(1 / weights_)) {
      advice.radius_by_turns_px = {by_turns_.value(), advice.radius_sd_px};
    }
    if (blur_.count() > 0) advice.blur_px2 = blur_.value();
    advice.light = by_turns_.count() > 0 ? light_ : bare_light_;
    advice.moved = moved_;
    if (nearness_.count() > 0) {
      advice.nearness = {nearness_.value(), std::max(nearness_.sd(), kNearnessSd)};
    }
    return advice;
  }

 private:
  bool learn_from(const BallPair& pair, const dic::RigidMotion& step) {
    const auto told = sphere_from_turn(engine_, pair, step, known_, far_);
    if (!told) return false;
    radius_.add(told->radius_px.value, told->radius_px.sd);
    by_turns_.add(told->radius_px.value, told->radius_px.sd);
    weights_ += 1 / (told->radius_px.sd * told->radius_px.sd);
    best_radius_sd_px_ = std::min(best_radius_sd_px_, told->radius_px.sd);
    blur_.add(told->blur_px2, 1);
    if (told->light && told->radius_px.sd <= best_radius_sd_px_) light_ = *told->light;
    if (told->nearness) nearness_.add(told->nearness->value, told->nearness->sd);
    return true;
  }

  void learn_from_paint(const BallPair& pair) {
    const Image<float> levels = pair.first.to_float();
    const double noise = dic::estimate_noise(levels.view(), pair.first.full_scale());
    const auto paint = seen_paint(pair.first, pair.first_ball);
    bare_light_ = sphere::light_on_bare_paint(paint, noise).value_or(BallLight{});
  }

  double unseen_tilt_rad() const {
    return std::isfinite(unseen_of_free_rad_) ? unseen_of_free_rad_ : unseen_of_pressed_rad_;
  }

  // Whether the ball turns out of the plane, in words.
  std::string decide() {
    char text[160];
    if (out_of_plane_) {
      std::snprintf(
          text, sizeof text,
          "the ball turns out of the picture's plane by %.2f deg a frame, %.0f deviations",
          most_deg_, significant_);
      return text;
    }
    for (const auto& [pair, step] : flat_) {
      const SlowTilt slow = slow_tilt(engine_, *pair, step, known_, far_);
      if (!slow.motion) {
        double& unseen_rad = slow.is_pressed ? unseen_of_pressed_rad_ : unseen_of_free_rad_;
        unseen_rad = std::fmax(unseen_rad, slow.unseen_rad);
        continue;
      }
      const dic::RigidMotion& tilted = *slow.motion;
      out_of_plane_ = true;
      learn_from(*pair, tilted);
      std::snprintf(
          text, sizeof text,
          "over many frames the ball turns out of the picture's plane, by %.3f deg a frame",
          std::hypot(tilted.rot_x_rad, tilted.rot_y_rad) * kDegPerRad);
      return text;
    }
    if (!is_measured()) return kUnmeasured;
    std::snprintf(text, sizeof text,
                  "no turn out of the picture's plane in %d pairs of frames (at most %.3f deg, "
                  "within chance)",
                  measured_, most_deg_);
    return text;
  }

  opencl::Engine& engine_;
  const motion::EstimatorOptions& known_;
  const FarFrames& far_;
  double most_deg_ = 0, significant_ = 0;
  int measured_ = 0;
  bool out_of_plane_ = false;
  // The most that some pair's surroundings leave open: of a ball as it is, and of one that is
  // pressed in one of the pictures.
  double unseen_of_free_rad_ = kNotMeasured, unseen_of_pressed_rad_ = kNotMeasured;
  WeightedMean radius_, by_turns_, nearness_, blur_;
  std::vector<MovedBall> moved_;
  BallLight light_{};                                                   // by the best far pair
  BallLight bare_light_{};                                              // by bare paint
  double weights_ = 0;                                                  // of by_turns_
  double best_radius_sd_px_ = std::numeric_limits<double>::infinity();  // of one far pair
  std::vector<std::pair<const BallPair*, dic::RigidMotion>> flat_;      // and what they moved by
};

}  // namespace

std::vector<MovedBall> discs_moved(opencl::Engine& engine, std::span<const BallPair> pairs,
                                   const motion::EstimatorOptions& known) {
  std::vector<MovedBall> moved;
  for (const BallPair& pair : pairs) {
    const dic::RigidMotion step = PairLook(engine, pair, known).flat_motion();
    if (step.ok) moved.push_back({pair.index, pair.first_ball, step});
  }
  return moved;
}

BodyAdvice judge_body(opencl::Engine& engine, std::span<const BallPair> pairs,
                      const motion::EstimatorOptions& known, const FarFrames& far) {
  Verdict verdict(engine, known, far);
  for (const BallPair& pair : pairs) verdict.look_at(pair);
  const double changes = out_of_round(pairs);
  if (!verdict.is_measured() && !(verdict.may_be_told() && changes <= kOutOfRound)) {
    BodyAdvice none;
    none.reason = unmeasured(changes);
    none.is_measured = false;
    return none;
  }
  return verdict.advice();
}

}  // namespace impactdic::advice
