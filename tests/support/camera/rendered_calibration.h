// A calibration from rendered pictures, as the program does it from files.
#pragma once

#include <string>
#include <vector>

#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/find_target.h"
#include "tests/support/camera/target_pictures.h"

namespace impactdic::testing {

// A target of 9 by 7 cells, 10 mm each.
inline CalibrateRequest rendered_target(CalibrationTarget target) {
  CalibrateRequest request;
  request.pictures = {"rendered"};
  request.target = target;
  request.columns = 9;
  request.rows = 7;
  request.pitch_mm = 10;
  request.dot_mm = 4.5;
  return request;
}

// Pictures, and what the finders see in them.
struct RenderedPictures {
  std::vector<Image<float>> levels;
  std::vector<camera::View> seen;
};

// `noise`: the first picture's seed of noise.
inline RenderedPictures rendered_pictures(const CalibrateRequest& request,
                                          const std::vector<Camera>& views, unsigned noise,
                                          const TargetScene& scene = {}) {
  const TargetPattern pattern(request);
  RenderedPictures pictures;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Frame frame = render_target(views[i], pattern, scene, noise + static_cast<unsigned>(i));
    camera::View view{std::to_string(i), camera::find_target(camera::to_grey(frame), request)};
    if (request.target != CalibrationTarget::kCharuco) {
      const int inner = request.target == CalibrationTarget::kDots ? 0 : 1;
      turn_back(views[i], camera::board_points(request), request.columns - inner, view.seen);
    }
    pictures.levels.push_back(frame.to_float());
    pictures.seen.push_back(std::move(view));
  }
  return pictures;
}

// In place of pictures: the target's points as each view shows them, with noise of `sd_px` along
// either axis.
inline std::vector<camera::View> noisy_views(const CalibrateRequest& request,
                                             const std::vector<Camera>& views, double sd_px,
                                             unsigned noise) {
  std::vector<camera::View> seen;
  for (const Camera& view : views) {
    std::mt19937 random(++noise);
    std::normal_distribution<double> off(0, sd_px);
    camera::View one{std::to_string(seen.size()), {}};
    for (const Eigen::Vector2d& at : project_target(view, camera::board_points(request))) {
      const double down = off(random), aside = off(random);
      one.seen.push_back({one.seen.size(), at + Eigen::Vector2d(aside, down)});
    }
    seen.push_back(std::move(one));
  }
  return seen;
}

inline CalibrateResult calibrate_rendered(const CalibrateRequest& request,
                                          const RenderedPictures& pictures) {
  return camera::calibrate_pictures(request, pictures.seen, pictures.levels[0].width(),
                                    pictures.levels[0].height(),
                                    [&](std::size_t i) { return pictures.levels[i]; });
}

}  // namespace impactdic::testing
