#include <cmath>

#include "host/motion/estimators.h"
#include "host/motion/unseen_tilt.h"

namespace impactdic::motion {
namespace {

// One registration of the whole ball, started from the field, or from circle and the rings' turn
// where the field has too little texture. Rigid, unless the field or the circle says that the ball
// is compressed.
class BallEstimator : public MotionEstimator {
 public:
  BallEstimator(opencl::Engine& engine, const EstimatorOptions& options, double radius_px,
                dic::DeviceFrames& frames)
      : options_(options),
        radius_px_(radius_px),
        field_(make_field_estimator(engine, options, radius_px, frames)),
        frames_(frames),
        rigid_(engine, ball_options(options, dic::BallModel::kRigid)),
        affine_(engine, ball_options(options, dic::BallModel::kAffine)) {}

  std::span<const Window> grid() const override { return field_->grid(); }
  double fit_seconds() const override { return field_->fit_seconds(); }

  void aim(std::span<PairMotion> pairs) override { field_->aim(pairs); }

  void measure(std::span<PairMotion> pairs) override {
    field_->measure(pairs);
    for (const std::size_t i : register_all(pairs)) {
      // A field that the whole ball does not bear out is chance.
      pairs[i].motion.ok = false;
      if (pairs[i].status == TrackStatus::kOk) pairs[i].status = TrackStatus::kLowCorrelation;
    }
  }

 private:
  // Deviations that strain is beyond noise, and the least that a rigid registration would notice.
  static constexpr double kSignificant = 5, kSmallest = 2e-4;

  // Strain beyond what noise makes, and beyond what a rigid registration would not notice.
  static bool is_strained(const PairMotion& pair) {
    if (pair.shape.is_compressed() || pair.second_shape.is_compressed()) return true;
    return pair.strain.ok && pair.strain.largest > kSmallest &&
           pair.strain.largest > kSignificant * pair.strain.sd;
  }

  // Of a few large speckles a rigid registration makes turns of strains that their field does not
  // tell: a ball that rings behind a contact changes its shape by less than 1 %.
  static bool may_be_strained(const PairMotion& pair) {
    constexpr double kTold = 1e-3;  // of the field's strain
    return !is_strained(pair) && !(pair.strain.ok && kSignificant * pair.strain.sd < kTold);
  }

  static bool shows_strain(const BallMotion& ball) {
    const double differ = std::hypot(ball.exx - ball.eyy, 2 * ball.exy) / 2;
    const double largest = std::abs(ball.exx + ball.eyy) / 2 + differ;
    const double sd = std::hypot(ball.exx_sd, ball.eyy_sd, ball.exy_sd);
    return largest > kSmallest && largest > kSignificant * sd;
  }

  // Registers every ball from where its field says. Returns those that could not be.
  std::vector<std::size_t> register_all(std::span<PairMotion> pairs) {
    std::vector<bool> done(pairs.size(), false);
    const auto always = [](const BallMotion&) { return true; };
    register_balls(
        pairs, rigid_, [](const PairMotion& pair) { return !is_strained(pair); }, always, done);
    register_balls(pairs, affine_, is_strained, always, done);
    register_balls(pairs, affine_, may_be_strained, shows_strain, done);
    std::vector<std::size_t> lost;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!done[i]) lost.push_back(i);
    }
    return lost;
  }

  // The pairs that are `chosen`; of their motions those that are `believed` are taken.
  template <typename Chosen, typename Believed>
  void register_balls(std::span<PairMotion> pairs, dic::BallRegistration& registration,
                      const Chosen& chosen, const Believed& believed, std::vector<bool>& done) {
    std::vector<BallTask> tasks;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!chosen(pairs[i])) continue;
      which.push_back(i);
      tasks.push_back(task_of(pairs[i]));
    }
    if (which.empty()) return;
    const std::vector<BallMotion> motions = registration.measure(frames_, tasks);
    for (std::size_t k = 0; k < which.size(); ++k) {
      if (motions[k].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
      if (!believed(motions[k])) continue;
      take_over(motions[k], pairs[which[k]]);
      done[which[k]] = true;
    }
  }

  BallTask task_of(const PairMotion& pair) const {
    BallTask task{};
    task.first = pair.first_slot;
    task.second = pair.second_slot;
    task.cx = static_cast<float>(pair.first.cx_px);
    task.cy = static_cast<float>(pair.first.cy_px);
    task.radius = static_cast<float>(radius_px_ - dic::kRimMarginPx);
    const dic::RigidMotion& seed = pair.motion;
    task.guess_dx = static_cast<float>(seed.ok ? seed.dx_px : pair.second.cx_px - pair.first.cx_px);
    task.guess_dy = static_cast<float>(seed.ok ? seed.dy_px : pair.second.cy_px - pair.first.cy_px);
    task.guess_rot_rad = static_cast<float>(seed.ok ? seed.rot_rad : pair.guess_rot_rad);
    return task;
  }

  void take_over(const BallMotion& ball, PairMotion& pair) const {
    const double tilt_rad = options_.unseen_tilt_rad;
    const double tilt_px = moved_by_tilt_px(tilt_rad, radius_px_);
    pair.motion.ok = true;
    pair.motion.dx_px = ball.dx;
    pair.motion.dy_px = ball.dy;
    pair.motion.rot_rad = ball.rot_rad;
    pair.motion.dx_sd_px = std::hypot(ball.dx_sd, tilt_px);
    pair.motion.dy_sd_px = std::hypot(ball.dy_sd, tilt_px);
    pair.motion.rot_sd_rad = std::hypot(ball.rot_sd_rad, turned_by_tilt(tilt_rad));
    pair.stretch = {ball.exx, ball.exy, ball.eyy};
    correct_turn(first_shape(pair, ball), ball, pair.motion);
    pair.status = TrackStatus::kOk;
  }

  // As its outline shows it, or where that took it for round, plainly the next one's.
  static BallShape first_shape(const PairMotion& pair, const BallMotion& ball) {
    constexpr double kPlain = 5;  // deviations
    if (pair.shape.is_compressed() || !pair.second_shape.is_compressed()) return pair.shape;
    const BallShape before = shape_before(pair.second_shape, ball);
    const bool plain = std::hypot(before.e1, before.e2) > kPlain * before.sd;
    return before.is_compressed() && plain ? before : pair.shape;
  }

  EstimatorOptions options_;
  double radius_px_;
  std::unique_ptr<MotionEstimator> field_;
  dic::DeviceFrames& frames_;
  dic::BallRegistration rigid_, affine_;
};

}  // namespace

dic::BallOptions ball_options(const FieldOptions& field, dic::BallModel model) {
  dic::BallOptions options;
  options.model = model;
  options.min_correlation = field.min_correlation;
  options.min_texture = field.min_texture;
  return options;
}

dic::BallOptions ball_options(const EstimatorOptions& options, dic::BallModel model) {
  dic::BallOptions whole = ball_options(options.field, model);
  whole.mask = options.moving;
  return whole;
}

dic::BallOptions body_options(const EstimatorOptions& options) {
  const auto model = options.sphere ? dic::BallModel::kSphere : dic::BallModel::kRigid;
  dic::BallOptions body = ball_options(options, model);
  body.lit = options.is_lit();
  return body;
}

std::unique_ptr<MotionEstimator> make_ball_estimator(opencl::Engine& engine,
                                                     const EstimatorOptions& options,
                                                     double radius_px, dic::DeviceFrames& frames) {
  return std::make_unique<BallEstimator>(engine, options, radius_px, frames);
}

}  // namespace impactdic::motion
