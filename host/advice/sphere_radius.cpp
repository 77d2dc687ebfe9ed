#include "host/advice/sphere_radius.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/advice/turned_paint.h"
#include "host/base/weighted_mean.h"
#include "host/dic/device/ball.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/sphere/source_response.h"

namespace impactdic::advice {
namespace {

constexpr double kTilt_deg = 25;     // farther, too little is seen in both pictures
constexpr std::int64_t kFewest = 2;  // frames; one is what the pair itself shows
// Beside chance, what a free radius is off by: foreshortened texture, and what the pictures are
// displaced by alike, over the turn in rad (four patterns, R 115 px, 9 to 27 degrees).
constexpr double kFreeSd_px = 0.012, kFreeShift_px = 0.0035;
// What light leaves of the pictures beside noise errs alike over more of the ball than the blocks
// that the registration takes to be independent: it counts so many times.
constexpr double kMisfitCounts = 2;
// No circle is told to be better than this: its texture turns under the rim.
constexpr double kLeastCircleSd_px = 0.005;
// The same of the radius over the distance (four patterns: 3e-4 at most), and from where to begin.
constexpr double kFreeNearnessSd = 6e-4, kFirstNearness = 0.02;
// What is an ellipse by more is no sphere, or pressed: turns of that tell another radius and
// another distance.
constexpr double kMostOval = 0.02;
// No camera stands nearer; and what of a turn must lie across that which a flight would make.
constexpr double kNearest = 0.12, kLeastAcross = 0.3;

// What blurs a picture: the pixel and the pre-smoothing, and a lens of 2 px at most.
constexpr double kLeastBlur_px2 = 0.33, kMostBlur_px2 = 4.33;

double tilt_deg(const Eigen::Vector3d& turn) {
  const double towards = dic::quaternion_of(turn).toRotationMatrix()(2, 2);
  return std::acos(std::clamp(towards, -1.0, 1.0)) * kDegPerRad;
}

// Frames until the ball is tilted so far, or has turned half around.
std::int64_t frames_to_tilt(const Eigen::Vector3d& step, std::int64_t most) {
  std::int64_t n = 1;
  while (n < most && tilt_deg(static_cast<double>(n) * step) < kTilt_deg &&
         static_cast<double>(n + 1) * step.norm() < kPi) {
    ++n;
  }
  return n;
}

class FarRegistration {
 public:
  FarRegistration(opencl::Engine& engine, const BallPair& pair,
                  const motion::EstimatorOptions& options)
      : engine_(engine),
        first_(pair.first),
        outline_(pair.first_ball),
        perspective_(options.perspective),
        frames_(engine, 2),
        free_options_(free_options(options)),
        given_options_(motion::ball_options(options, dic::BallModel::kSphere)),
        free_(std::in_place, engine, free_options_),
        given_(std::in_place, engine, given_options_) {
    frames_.set(0, pair.first);
  }

  // What noise leaves of pictures in which the ball has hardly turned, by `turn`.
  void look_at_next(const BallPair& pair, const Eigen::Vector3d& turn) {
    frames_.set(1, pair.second);
    motion::Perspective seen = perspective_;
    if (seen.is_unknown()) seen.by_distance_per_px = 0;
    const dic::RigidMotion start = expected(pair.second_ball, turn, seen);
    const Circle first = motion::about_centre(outline_, seen);
    const auto next = registered(given_, first, outline_.r_px, start, seen);
    if (next) of_noise_ = next->residual;
  }

  // `turn`: rotation vector that is expected, rad.
  std::optional<SphereTold> tell(const BallPicture& far, const Eigen::Vector3d& turn) {
    frames_.set(1, far.picture);
    motion::Perspective seen = perspective_;
    if (seen.is_unknown()) seen.by_distance_per_px = kFirstNearness / outline_.r_px;
    Circle first = motion::about_centre(outline_, seen);
    auto found = registered(free_, first, outline_.r_px, expected(far.ball, turn, seen), seen);
    if (!found || !(found->ball_radius_sd > 0)) return std::nullopt;
    learn_light(far.picture, *found, seen);
    learn_blur(*found, seen);
    dic::RigidMotion near = motion::sphere_motion(*found);
    if (perspective_.is_unknown()) {
      // The nearer the ball, the farther is its centre from the outline's.
      motion::Perspective better = seen;
      better.by_distance_per_px = found->by_distance;
      first = motion::about_centre(outline_, better);
      near = expected(far.ball, turn, better);
    }
    found = registered(free_, first, found->ball_radius, near, seen);
    if (!found || !(found->ball_radius_sd > 0)) return std::nullopt;
    if (light_) {
      // Its first guess came from a turn that took light for depth.
      learn_light(far.picture, *found, seen);
      found = registered(free_, first, found->ball_radius, motion::sphere_motion(*found), seen);
      if (!found || !(found->ball_radius_sd > 0)) return std::nullopt;
    }
    SphereTold told;
    told.blur_px2 = blur_px2_;
    told.light = light_;
    if (perspective_.is_unknown()) {
      if (!is_ambiguous(*found)) told.nearness = nearness_of(*found);
      seen.by_distance_per_px = found->by_distance;
    }
    const double radius_px = found->ball_radius;
    const auto given =
        registered(given_, centred(*found), radius_px, motion::sphere_motion(*found), seen);
    if (!given) return std::nullopt;
    dic::RigidMotion of_circles = expected(far.ball, turn, seen);
    of_circles.dx_px += first.cx_px - found->cx;
    of_circles.dy_px += first.cy_px - found->cy;
    of_circles.dx_sd_px = std::hypot(found->cx_sd, circle_sd_px(far.ball));
    of_circles.dy_sd_px = std::hypot(found->cy_sd, circle_sd_px(far.ball));
    WeightedMean sum;
    const double tilt_rad = tilt_deg(turn) * kRadPerDeg;
    const double free_sd_px =
        std::hypot(found->ball_radius_sd, kFreeSd_px, kFreeShift_px / tilt_rad);
    sum.add(radius_px, free_sd_px * std::sqrt(1 + kMisfitCounts * misfit(*found)));
    add_circles(motion::sphere_motion(*given), of_circles, radius_px, sum);
    told.radius_px = {sum.value(), sum.sd()};
    return told;
  }

 private:
  static dic::BallOptions free_options(const motion::EstimatorOptions& options) {
    dic::BallOptions free = motion::ball_options(
        options, options.perspective.is_unknown() ? dic::BallModel::kSphereRadiusAndDistance
                                                  : dic::BallModel::kSphereAndRadius);
    free.free_centre = true;
    return free;
  }

  // Of what is left of the pictures, the variance that is not noise, over that of noise.
  double misfit(const BallMotion& found) const {
    return of_noise_ > 0 ? std::max(0.0, std::pow(found.residual / of_noise_, 2) - 1) : 0;
  }

  static double circle_sd_px(const FoundBall& ball) {
    return std::max(ball.centre_sd_px, kLeastCircleSd_px);
  }

  // The ball in the first picture as it was found.
  Circle centred(const BallMotion& found) const {
    Circle ball = outline_;
    ball.cx_px = found.cx;
    ball.cy_px = found.cy;
    return ball;
  }

  static Measured nearness_of(const BallMotion& found) {
    return {found.by_distance * found.ball_radius,
            std::hypot(found.by_distance_sd * found.ball_radius, kFreeNearnessSd)};
  }

  // A ball that flies past turns as it is seen, by its flight over the distance. With the nearness
  // k what it turns and flies is, to second order, as with c / d - k, c being the turn that is seen
  // and d the flight in radii, unless c has a part across what a flight would make of it: two
  // answers, and no picture tells which.
  static bool is_ambiguous(const BallMotion& found) {
    const double radius_px = found.ball_radius, nearness = found.by_distance * radius_px;
    const Eigen::Vector2d flown(found.dx / radius_px, -found.dy / radius_px);
    if (!(flown.norm() > 0)) return false;
    const Eigen::Vector2d seen_by_flight(-flown.y(), flown.x());
    const Eigen::Vector2d along = seen_by_flight.normalized();
    const Eigen::Vector2d turn(found.rot_x_rad, found.rot_y_rad);
    const Eigen::Vector2d seen = turn + nearness * seen_by_flight;
    const double across = (seen - seen.dot(along) * along).norm();
    const double other = seen.dot(along) / flown.norm() - nearness;
    return across < kLeastAcross * std::abs(seen.dot(along)) && other > -kNearest / 4 &&
           other < kNearest;
  }

  dic::RigidMotion expected(const FoundBall& far, const Eigen::Vector3d& turn,
                            const motion::Perspective& seen) const {
    const Circle first = motion::about_centre(outline_, seen);
    const Circle second = motion::about_centre(far, seen);
    dic::RigidMotion motion;
    motion.dx_px = second.cx_px - first.cx_px;
    motion.dy_px = second.cy_px - first.cy_px;
    motion.rot_x_rad = turn.x();
    motion.rot_y_rad = turn.y();
    motion.rot_rad = turn.z();
    return motion;
  }

  // Looks at what the turn shows of the light; from then on registrations know it.
  void learn_light(const Frame& second, const BallMotion& found, const motion::Perspective& seen) {
    const double noise = of_noise_ > 0 ? of_noise_ : found.residual;
    const auto told = sphere::light_on_paint(turned_paint(first_, second, found, seen), noise);
    if (!told) return;
    light_ = told;
    if (free_options_.lit) return;
    free_options_.lit = given_options_.lit = true;
    free_.emplace(engine_, free_options_);
    given_.emplace(engine_, given_options_);
  }

  // What blurs the pictures is what leaves the least of them: the vertex of the parabola that the
  // squares left over make with it.
  void learn_blur(const BallMotion& found, const motion::Perspective& seen) {
    constexpr double kStep = kUsual / 2;
    double left[3];
    for (int i : {0, 1, 2}) {
      blur_px2_ = kUsual + (i - 1) * kStep;
      const auto given =
          registered(given_, centred(found), found.ball_radius, motion::sphere_motion(found), seen);
      left[i] = given ? std::pow(given->residual, 2) : std::numeric_limits<double>::quiet_NaN();
    }
    const double bent = left[0] - 2 * left[1] + left[2];
    const double vertex = kUsual + kStep / 2 * (left[0] - left[2]) / bent;
    blur_px2_ = bent > 0 ? std::clamp(vertex, kLeastBlur_px2, kMostBlur_px2) : kUsual;
  }

  // From the ball in `first`, about its centre.
  std::optional<BallMotion> registered(std::optional<dic::BallRegistration>& registration,
                                       const Circle& first, double radius_px,
                                       const dic::RigidMotion& start,
                                       const motion::Perspective& seen) {
    BallTask task = motion::sphere_task(first, radius_px, blur_px2_, start);
    task.second = 1;
    task.centre_sd = static_cast<float>(circle_sd_px(outline_));
    task.sight = motion::sight_of(seen, outline_.r_px, {first, {}}, {}, first.cx_px, first.cy_px);
    if (light_) task.light = *light_;
    const BallMotion motion = registration->measure(frames_, {&task, 1})[0];
    if (motion.status != static_cast<idic_int>(WindowStatus::kOk)) return std::nullopt;
    return motion;
  }

  // The radii with which the displacements would be those of the circles.
  static void add_circles(const dic::RigidMotion& motion, const dic::RigidMotion& of_circles,
                          double radius_px, WeightedMean& sum) {
    const auto response = sphere::source_response(
        {{motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad}, radius_px, {}, {}});
    const auto add = [&](double missed_px, double sd_px, double slope) {
      if (slope != 0) sum.add(radius_px + missed_px / slope, sd_px / std::abs(slope));
    };
    add(of_circles.dx_px - motion.dx_px, std::hypot(motion.dx_sd_px, of_circles.dx_sd_px),
        response.dx[sphere::kToRadius]);
    add(of_circles.dy_px - motion.dy_px, std::hypot(motion.dy_sd_px, of_circles.dy_sd_px),
        response.dy[sphere::kToRadius]);
  }

  static constexpr double kUsual = sphere::kUsualBlur_px2;
  opencl::Engine& engine_;
  const Frame& first_;
  FoundBall outline_;
  std::optional<BallLight> light_;
  double blur_px2_ = kUsual;
  double of_noise_ = 0;  // rms, grey levels; 0: not known
  motion::Perspective perspective_;
  dic::DeviceFrames frames_;
  dic::BallOptions free_options_, given_options_;
  std::optional<dic::BallRegistration> free_, given_;
};

}  // namespace

FarFrames far_frames(FrameSource& source, const AdviceRequest& request) {
  return {last_looked_at(source, request.frames) + 1,
          request.roi.width,
          request.roi.height,
          [&source, &request](std::int64_t index, const Circle& near) {
            return look_for_ball(source, request, index, near);
          },
          [&source, &request](std::int64_t index, const Circle& guess) {
            return look_near(source, request, index, guess);
          },
          [&source, &request](std::int64_t index) { return read_picture(source, request, index); }};
}

std::optional<SphereTold> sphere_from_turn(opencl::Engine& engine, const BallPair& pair,
                                           const dic::RigidMotion& step,
                                           const motion::EstimatorOptions& options,
                                           const FarFrames& frames) {
  if (pair.first_ball.oval > kMostOval) return std::nullopt;
  const Eigen::Vector3d turn(step.rot_x_rad, step.rot_y_rad, step.rot_rad);
  const std::int64_t ahead = frames.count - 1 - pair.index;
  std::int64_t n = frames_to_tilt(turn, std::max(ahead, pair.index));
  const int side = n <= ahead || ahead >= pair.index ? 1 : -1;
  FarRegistration registration(engine, pair, options);
  registration.look_at_next(pair, turn);
  const std::int64_t fewest = options.perspective.is_unknown() ? 1 : kFewest;
  for (; n >= fewest; n /= 2) {
    const double steps = side * static_cast<double>(n);
    Circle near = pair.first_ball;
    near.cx_px += steps * step.dx_px;
    near.cy_px += steps * step.dy_px;
    const auto far = frames.find(pair.index + side * n, near);
    if (!far || far->ball.oval > kMostOval) continue;
    if (const auto told = registration.tell(*far, steps * turn)) return told;
  }
  return std::nullopt;
}

}  // namespace impactdic::advice
