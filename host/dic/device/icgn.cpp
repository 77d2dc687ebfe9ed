#include "host/dic/device/icgn.h"

#include <limits>

#include "host/dic/frames/spline_taps.h"
#include "host/opencl/arguments.h"

namespace impactdic::dic {

opencl::ProgramRequest IcgnRefiner::program(const opencl::Engine& engine,
                                            const FieldOptions& options,
                                            std::optional<Tiling> asked) {
  const Tiling tiling = choose_tiling(engine, asked, 32);
  return {"icgn/icgn.cl",
          {{"SPLINE_DEGREE", std::to_string(options.spline_degree)},
           {"VECTOR", std::to_string(tiling.vector)},
           {"GROUP", std::to_string(tiling.group)},
           {"WINDOW_PX", std::to_string(options.window_px)}}};
}

IcgnRefiner::IcgnRefiner(opencl::Engine& engine, const FieldOptions& options, int slots,
                         std::optional<Tiling> tiling)
    : engine_(engine),
      options_(options),
      tiling_(choose_tiling(engine, tiling, 32)),
      device_discs_(engine, static_cast<std::size_t>(slots)) {
  if (options.window_px < 5 || options.window_px > 129) {
    throw InvalidArgument("the window must be 5 … 129 px wide", "--window");
  }
  kernel_ = engine.kernel(program(engine, options, tiling_), "refine_windows");
  const float endless = std::numeric_limits<float>::infinity();
  discs_.assign(static_cast<std::size_t>(slots), {{0, 0, endless, 0}});
  const auto noise = interpolation_noise(options.spline_degree, 0.0);
  noise_ = {{static_cast<float>(noise[0]), static_cast<float>(noise[1]),
             static_cast<float>(noise[2]), static_cast<float>(slope_noise(options.spline_degree))}};
}

void IcgnRefiner::set_disc(int slot, double cx_px, double cy_px, double radius_px) {
  if (slot < 0 || slot >= static_cast<int>(discs_.size()))
    throw InvalidArgument("no such frame slot");
  discs_[static_cast<std::size_t>(slot)] = {{static_cast<float>(cx_px), static_cast<float>(cy_px),
                                             static_cast<float>(radius_px * radius_px), 0}};
  discs_changed_ = true;
}

void IcgnRefiner::refine(DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                         std::size_t count, opencl::Buffer<WindowMotion>& in_out) {
  if (count > windows.size() || count > in_out.size()) {
    throw InvalidArgument("more windows asked for than the buffers hold");
  }
  if (count == 0) return;
  const SplineFrames& splines = frames.splines(options_.spline_degree, 0.0, tiling_);
  if (discs_changed_) device_discs_.write_later(engine_, discs_);
  discs_changed_ = false;
  const double levels = frames.full_scale() / 255.0;
  opencl::set_arguments(kernel_, splines.coefficients().get(), splines.coefficient_offset(),
                        splines.planes().get(), splines.width(), splines.height(), splines.pitch(),
                        splines.plane_pitch(), device_discs_.get(), windows.get(), in_out.get(),
                        static_cast<float>(options_.min_texture * levels),
                        static_cast<float>(options_.min_correlation), options_.max_iterations,
                        noise_, static_cast<float>(pixel_variance(options_, frames.full_scale())),
                        static_cast<float>(options_.max_sd_px));
  const auto group = static_cast<std::size_t>(tiling_.group);
  const double pixels = static_cast<double>(count) * options_.window_px * options_.window_px;
  const double taps = options_.spline_degree + 1.0;
  // Three steps are typical; the normal matrix counts as one more.
  engine_.launch(engine_.queue(), kernel_, cl::NDRange(count * group), cl::NDRange(group),
                 {pixels * 12, pixels * (3 * (2 * taps * taps + 60) + 100)});
}

}  // namespace impactdic::dic
