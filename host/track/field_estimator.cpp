#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/base/stopwatch.h"
#include "host/dic/window_correlator.h"
#include "host/track/estimators.h"

namespace impactdic {
namespace {

class FieldEstimator : public MotionEstimator {
 public:
  FieldEstimator(Engine& engine, const EstimatorOptions& options, double radius_px,
                 DeviceFrames& frames)
      : options_(options), frames_(frames), correlator_(engine, options.field, frames.slots()) {
    grid_ = disc_grid(0, 0, radius_px - options.rim_margin_px, options.field.window_px,
                      options.effective_spacing_px());
  }

  std::span<const Window> grid() const override { return grid_; }
  double fit_seconds() const override { return fit_seconds_; }

  void measure(std::span<PairMotion> pairs) override {
    std::vector<Window> all(pairs.size() * grid_.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
      place(pairs[i]);
      std::copy(pairs[i].windows.begin(), pairs[i].windows.end(),
                all.begin() + static_cast<std::ptrdiff_t>(i * grid_.size()));
    });
    const std::vector<WindowMotion> measured = correlator_.correlate(frames_, all);
    const Stopwatch watch;
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
      const auto begin = measured.begin() + static_cast<std::ptrdiff_t>(i * grid_.size());
      pairs[i].field.assign(begin, begin + static_cast<std::ptrdiff_t>(grid_.size()));
      fit(pairs[i]);
    });
    fit_seconds_ += watch.seconds();
  }

 private:
  void place(PairMotion& pair) const {
    pair.windows = grid_;
    const int x = static_cast<int>(std::lround(pair.first.cx_px));
    const int y = static_cast<int>(std::lround(pair.first.cy_px));
    for (Window& window : pair.windows) {
      window.x0 += x;
      window.y0 += y;
    }
    aim_windows(pair.windows, options_.field.window_px, pair.first_slot, pair.second_slot,
                {pair.first.cx_px, pair.first.cy_px, pair.second.cx_px - pair.first.cx_px,
                 pair.second.cy_px - pair.first.cy_px, pair.guess_rot_rad});
  }

  void fit(PairMotion& pair) const {
    const auto points = field_points(pair.windows, pair.field, options_.field.window_px);
    pair.motion = fit_rigid_motion(points, pair.first.cx_px, pair.first.cy_px);
    if (pair.motion.used < options_.fewest_windows) pair.motion.ok = false;
    pair.centre = interpolate_at(points, pair.first.cx_px, pair.first.cy_px);
    pair.strain = fit_strain(points);
    pair.status = pair.motion.ok ? TrackStatus::ok : explain_failure(pair.field);
  }

  EstimatorOptions options_;
  DeviceFrames& frames_;
  WindowCorrelator correlator_;
  std::vector<Window> grid_;
  double fit_seconds_ = 0;
};

}  // namespace

std::unique_ptr<MotionEstimator> make_field_estimator(Engine& engine,
                                                      const EstimatorOptions& options,
                                                      double radius_px, DeviceFrames& frames) {
  return std::make_unique<FieldEstimator>(engine, options, radius_px, frames);
}

}  // namespace impactdic
