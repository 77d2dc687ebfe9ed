#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/stopwatch.h"
#include "host/dic/device/ring.h"
#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_fit.h"
#include "host/dic/window_correlator.h"
#include "host/motion/estimators.h"

namespace impactdic::motion {
namespace {

// Of a window that the rim cuts, the share on the ball. IC-GN asks for half, of every frame's disc.
constexpr double kInside = 0.55;

dic::RigidMotion motion_of(const dic::SphereFit& fit) {
  dic::RigidMotion motion;
  motion.ok = fit.ok;
  motion.dx_px = fit.dx_px;
  motion.dy_px = fit.dy_px;
  const Eigen::Vector3d turn = dic::rotation_vector(fit.turn);
  motion.rot_x_rad = turn.x();
  motion.rot_y_rad = turn.y();
  motion.rot_rad = turn.z();
  motion.used = fit.used;
  motion.residual_px = fit.residual_px;
  return motion;
}

class FieldEstimator : public MotionEstimator {
 public:
  FieldEstimator(opencl::Engine& engine, const EstimatorOptions& options, double radius_px,
                 dic::DeviceFrames& frames)
      : options_(options),
        radius_px_(radius_px),
        frames_(frames),
        correlator_(engine, options.field, frames.slots()),
        ring_(engine, {}) {
    const bool cut = options.field.method == FieldMethod::kIcgn;
    grid_ = dic::disc_grid(0, 0, radius_px - options.rim_margin_px, options.field.window_px,
                           options.effective_spacing_px(), cut ? kInside : 1);
  }

  std::span<const Window> grid() const override { return grid_; }
  double fit_seconds() const override { return fit_seconds_; }

  void measure(std::span<PairMotion> pairs) override { measure_all(pairs, Effort::kAll); }
  void aim(std::span<PairMotion> pairs) override { measure_all(pairs, Effort::kAim); }

 private:
  // Of the windows that could be found, the share that must agree. Below the first the spin may be
  // another than expected; below the second the few that agree do so by chance.
  static constexpr double kWellFound = 0.3, kFound = 0.2;
  // Of windows that were followed, the share that must agree, and how far the guess may be off.
  static constexpr double kWellFollowed = 0.5, kFollowed_px = 1;

  // Of all windows what there is to know, or of those wholly on the ball where they went.
  enum class Effort : std::uint8_t { kAll, kAim };

  void measure_all(std::span<PairMotion> pairs, Effort effort) {
    std::vector<PairMotion*> all;
    for (PairMotion& pair : pairs) all.push_back(&pair);
    measure_from_guess(all, effort);
    if (!options_.sphere) measure_lost(pairs, effort);
  }

  void measure_from_guess(std::span<PairMotion* const> pairs, Effort effort) {
    if (effort == Effort::kAim || options_.field.method != FieldMethod::kIcgn) {
      measure_with(pairs, effort == Effort::kAll ? Way::kSearch : Way::kAim);
      return;
    }
    measure_with(pairs, Way::kFollow);
    std::vector<PairMotion*> astray;
    for (PairMotion* pair : pairs) {
      if (!went_as_guessed(*pair)) astray.push_back(pair);
    }
    if (!astray.empty()) measure_with(astray, Way::kSearch);
  }

  // How windows are looked for: in a search area, wholly or for an aim alone, or where the guess
  // says that they went.
  enum class Way : std::uint8_t { kSearch, kAim, kFollow };

  void measure_with(std::span<PairMotion* const> pairs, Way way) {
    windows_.resize(pairs.size() * grid_.size());
    seeds_.resize(way == Way::kFollow ? windows_.size() : 0);
    auto next = windows_.begin();
    for (PairMotion* pair : pairs) {
      const auto at = static_cast<std::size_t>(next - windows_.begin());
      place(*pair, way == Way::kFollow ? std::span(seeds_).subspan(at, grid_.size())
                                       : std::span<WindowMotion>());
      next = std::copy(pair->windows.begin(), pair->windows.end(), next);
      correlator_.set_disc(pair->first_slot, pair->first.cx_px, pair->first.cy_px,
                           pair->first.r_px - options_.rim_margin_px);
    }
    const std::vector<WindowMotion>& measured =
        way == Way::kFollow   ? correlator_.follow(frames_, windows_, seeds_)
        : way == Way::kSearch ? correlator_.correlate(frames_, windows_)
                              : correlator_.find(frames_, windows_);
    const Stopwatch watch;
    auto begin = measured.begin();
    for (PairMotion* pair : pairs) {
      const auto end = begin + static_cast<std::ptrdiff_t>(grid_.size());
      pair->field.assign(begin, end);
      fit(*pair);
      begin = end;
    }
    fit_seconds_ += watch.seconds();
  }

  // Whether windows that were followed were followed rightly: most agree, on what was expected.
  // Those that start farther off than a speckle's flank may settle on another.
  bool went_as_guessed(const PairMotion& pair) const {
    if (!pair.motion.ok || agreeing_share(pair.motion, pair.field) < kWellFollowed) return false;
    const double shift = std::hypot(pair.motion.dx_px - (pair.second.cx_px - pair.first.cx_px),
                                    pair.motion.dy_px - (pair.second.cy_px - pair.first.cy_px));
    const double turn = std::hypot(pair.motion.rot_x_rad - pair.guess_rot_x_rad,
                                   pair.motion.rot_y_rad - pair.guess_rot_y_rad,
                                   pair.motion.rot_rad - pair.guess_rot_rad);
    return shift + turn * radius_px_ < kFollowed_px;
  }

  // Where the windows found little, rings about the centres say how far the ball turned, whatever
  // the angle, and the windows look there.
  void measure_lost(std::span<PairMotion> pairs, Effort effort) {
    constexpr double kSameGuess_rad = 0.02;
    std::vector<PairMotion*> lost;
    std::vector<RingTask> tasks;
    for (PairMotion& pair : pairs) {
      if (pair.motion.ok && agreeing_share(pair.motion, pair.field) > kWellFound) continue;
      lost.push_back(&pair);
      tasks.push_back(ring_task(pair, radius_px_));
    }
    if (lost.empty()) return;
    const std::vector<dic::RingMotion> turns = ring_.measure(frames_, tasks);
    std::vector<PairMotion> again;
    std::vector<PairMotion*> of;
    for (std::size_t i = 0; i < lost.size(); ++i) {
      if (turns[i].status != WindowStatus::kOk) continue;
      const bool same = std::abs(turns[i].rot_rad - lost[i]->guess_rot_rad) < kSameGuess_rad;
      lost[i]->guess_rot_rad = turns[i].rot_rad;
      if (same) continue;
      again.push_back(*lost[i]);
      of.push_back(lost[i]);
    }
    if (again.empty()) return;
    std::vector<PairMotion*> anew;
    for (PairMotion& pair : again) anew.push_back(&pair);
    measure_from_guess(anew, effort);
    for (std::size_t i = 0; i < again.size(); ++i) {
      const bool better = agreeing_share(again[i].motion, again[i].field) >
                          agreeing_share(of[i]->motion, of[i]->field);
      if (again[i].motion.ok && better) *of[i] = std::move(again[i]);
    }
  }

  void place(PairMotion& pair, std::span<WindowMotion> seeds) const {
    pair.windows = grid_;
    const int x = static_cast<int>(std::lround(pair.first.cx_px));
    const int y = static_cast<int>(std::lround(pair.first.cy_px));
    for (Window& window : pair.windows) {
      window.x0 += x;
      window.y0 += y;
    }
    if (options_.sphere) {
      aim_on_sphere(pair.windows, options_.field.window_px, pair.first_slot, pair.second_slot,
                    sphere_guess(pair), seeds);
      return;
    }
    aim_windows(pair.windows, options_.field.window_px, pair.first_slot, pair.second_slot,
                {pair.first.cx_px, pair.first.cy_px, pair.second.cx_px - pair.first.cx_px,
                 pair.second.cy_px - pair.first.cy_px, pair.guess_rot_rad},
                seeds);
  }

  dic::SphereGuess sphere_guess(const PairMotion& pair) const {
    dic::SphereGuess guess;
    guess.cx_px = pair.first.cx_px;
    guess.cy_px = pair.first.cy_px;
    guess.radius_px = options_.sphere_radius(radius_px_);
    guess.dx_px = pair.second.cx_px - pair.first.cx_px;
    guess.dy_px = pair.second.cy_px - pair.first.cy_px;
    guess.turn =
        dic::quaternion_of({pair.guess_rot_x_rad, pair.guess_rot_y_rad, pair.guess_rot_rad});
    return guess;
  }

  void fit(PairMotion& pair) const {
    const auto points = field_points(pair.windows, pair.field, options_.field.window_px);
    pair.motion = options_.sphere
                      ? motion_of(dic::fit_sphere_motion(points, sphere_guess(pair)))
                      : dic::fit_rigid_motion(points, pair.first.cx_px, pair.first.cy_px);
    account_for_overlap(pair.motion, options_.field.window_px, options_.effective_spacing_px());
    if (pair.motion.used < options_.fewest_windows ||
        agreeing_share(pair.motion, pair.field) < kFound) {
      pair.motion.ok = false;
    }
    pair.centre = interpolate_at(points, pair.first.cx_px, pair.first.cy_px);
    if (options_.estimator == Estimator::kBall && !options_.sphere) {
      pair.strain = fit_strain(points, pair.motion, pair.first.cx_px, pair.first.cy_px);
    }
    pair.status = pair.motion.ok ? TrackStatus::kOk : explain_failure(pair.field);
  }

  EstimatorOptions options_;
  double radius_px_;
  dic::DeviceFrames& frames_;
  dic::WindowCorrelator correlator_;
  dic::RingRotation ring_;
  std::vector<Window> grid_;
  // Of all pairs; kept, since fresh memory is slow for threads that ask for it at once.
  std::vector<Window> windows_;
  std::vector<WindowMotion> seeds_;
  double fit_seconds_ = 0;
};

}  // namespace

std::unique_ptr<MotionEstimator> make_field_estimator(opencl::Engine& engine,
                                                      const EstimatorOptions& options,
                                                      double radius_px, dic::DeviceFrames& frames) {
  return std::make_unique<FieldEstimator>(engine, options, radius_px, frames);
}

}  // namespace impactdic::motion
