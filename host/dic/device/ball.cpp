#include "host/dic/device/ball.h"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <numeric>

#include "host/dic/frames/spline_taps.h"
#include "host/opencl/arguments.h"

namespace impactdic::dic {
namespace {

constexpr int kGroupOnGpu = 512;

bool is_shaped(const BallSight& sight) {
  const float numbers[] = {sight.by_distance, sight.first[0],  sight.first[1], sight.first[2],
                           sight.second[0],   sight.second[1], sight.second[2]};
  return std::any_of(std::begin(numbers), std::end(numbers), [](float x) { return x != 0; });
}

int parameters(BallModel model) {
  switch (model) {
    case BallModel::kRigid:
      return 3;
    case BallModel::kAffine:
      return 6;
    case BallModel::kSphere:
    case BallModel::kSphereAndRadius:
    case BallModel::kSphereRadiusAndDistance:
      return 5;
  }
  return 3;
}

bool is_sphere(BallModel model) { return parameters(model) == 5; }

const char* flag(bool set) { return set ? "1" : "0"; }

}  // namespace

void BallOptions::validate() const {
  check_spline(spline_degree, presmooth_sigma_px);
  if (max_steps < 1) throw InvalidArgument("the registration needs at least one step");
  if (!(min_correlation >= -1 && min_correlation <= 1)) {
    throw InvalidArgument("the smallest correlation must lie in -1 ... 1");
  }
  if (free_centre && !is_sphere(model))
    throw InvalidArgument("only a sphere's turn tells its centre");
  if (lit && !is_sphere(model)) throw InvalidArgument("only a sphere's light is known");
  if (!(min_texture >= 0)) throw InvalidArgument("the smallest texture must not be negative");
}

BallRegistration::BallRegistration(opencl::Engine& engine, const BallOptions& options,
                                   std::optional<Tiling> tiling)
    : engine_(engine),
      options_((options.validate(), options)),
      tiling_(choose_tiling(engine, tiling, kGroupOnGpu)) {
  const auto taps = gaussian_taps(options.presmooth_sigma_px);
  smooth_taps_ = opencl::make_buffer<float>(engine, std::vector<float>(taps.begin(), taps.end()));
  const auto noise = interpolation_noise(options.spline_degree, options.presmooth_sigma_px);
  const double at_pixel = noise[0] + noise[1] + noise[2];
  noise_ = {{static_cast<float>(noise[0]), static_cast<float>(noise[1]),
             static_cast<float>(noise[2]), static_cast<float>(at_pixel * at_pixel)}};
}

opencl::ProgramRequest BallRegistration::program(const opencl::Engine& engine,
                                                 const BallOptions& options, bool shaped,
                                                 std::optional<Tiling> asked) {
  using enum BallModel;
  const Tiling tiling = choose_tiling(engine, asked, kGroupOnGpu);
  const bool distance = options.model == kSphereRadiusAndDistance;
  const std::size_t smooth_radius = gaussian_taps(options.presmooth_sigma_px).size() - 1;
  return {"ball/rigid.cl",
          {{"SPLINE_DEGREE", std::to_string(options.spline_degree)},
           {"VECTOR", std::to_string(tiling.vector)},
           {"GROUP", std::to_string(tiling.group)},
           {"PARAMETERS", std::to_string(parameters(options.model))},
           {"FREE_RADIUS", flag(distance || options.model == kSphereAndRadius)},
           {"FREE_DISTANCE", flag(distance)},
           {"FREE_CENTRE", flag(options.free_centre)},
           {"SHAPED", flag(shaped)},
           {"LIT", flag(options.lit)},
           {"SMOOTH_RADIUS", std::to_string(smooth_radius)},
           {"MASKED", flag(options.mask != nullptr)}}};
}

cl::Kernel& BallRegistration::kernel(bool shaped) {
  cl::Kernel& kernel = kernels_[shaped ? 1 : 0];
  if (kernel() == nullptr) {
    kernel = engine_.kernel(program(engine_, options_, shaped, tiling_), "register_balls");
  }
  return kernel;
}

void BallRegistration::write_mask() {
  if (!is_masked()) {
    mask_ = opencl::Buffer<float>(engine_, 1);
    corners_ = opencl::Buffer<cl_int2>(engine_, 1);
    return;
  }
  const Image<std::uint8_t>& mask = *options_.mask;
  // Kernels may read some pixels more than there are in a row.
  std::vector<float> weights(mask.size() + kBytesBehind / sizeof(float));
  std::transform(mask.data(), mask.data() + mask.size(), weights.begin(),
                 [](std::uint8_t pixel) { return pixel != 0 ? 1.0F : 0.0F; });
  if (options_.mask_is_body) {
    mask_area_ = std::accumulate(weights.begin(), weights.end(), 0.0F);
  }
  mask_ = opencl::make_buffer<float>(engine_, weights);
}

std::vector<cl_int2> BallRegistration::corners_of(const DeviceFrames& frames) const {
  std::vector<cl_int2> corners;
  if (!is_masked()) return corners;
  const Image<std::uint8_t>& mask = *options_.mask;
  for (const PartCorner& corner : frames.corners()) {
    if (corner.x + frames.width() > mask.width() || corner.y + frames.height() > mask.height()) {
      throw InvalidArgument("the mask is smaller than the pictures");
    }
    corners.push_back({{corner.x, corner.y}});
  }
  return corners;
}

std::vector<BallMotion> BallRegistration::measure(DeviceFrames& frames,
                                                  std::span<const BallTask> tasks) {
  std::vector<BallTask> of_kind[2];
  std::vector<std::size_t> place[2];
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const bool shaped = is_shaped(tasks[i].sight);
    if (shaped && !is_sphere(options_.model)) {
      throw InvalidArgument("only a sphere is seen in perspective");
    }
    if (!(tasks[i].sight.by_distance > 0) &&
        options_.model == BallModel::kSphereRadiusAndDistance) {
      throw InvalidArgument("a distance that is to be found needs one to begin with");
    }
    place[shaped].push_back(i);
    of_kind[shaped].push_back(tasks[i]);
  }
  if (place[1].empty()) return launch(frames, tasks, false);
  std::vector<BallMotion> motions(tasks.size());
  for (const bool shaped : {false, true}) {
    const std::vector<BallMotion> some = launch(frames, of_kind[shaped], shaped);
    for (std::size_t i = 0; i < some.size(); ++i) motions[place[shaped][i]] = some[i];
  }
  return motions;
}

// Pixels of all tasks' discs. Throws InvalidArgument for a task that cannot be measured.
double BallRegistration::checked_pixels(const DeviceFrames& frames,
                                        std::span<const BallTask> tasks) const {
  double pixels = 0;
  for (const BallTask& task : tasks) {
    for (const int slot : {task.first, task.second}) {
      if (frames.version(slot) == 0) throw InvalidArgument("a frame slot is empty");
    }
    if (!(task.radius > 0)) throw InvalidArgument("a ball's radius must be positive");
    if (is_sphere(options_.model) && !(task.ball_radius >= task.radius)) {
      throw InvalidArgument("a sphere's radius must reach its disc's");
    }
    if (options_.free_centre && !(task.centre_sd > 0)) {
      throw InvalidArgument("a centre that is to be found needs a deviation");
    }
    if (options_.lit && !(task.light.least > 0)) {
      throw InvalidArgument("a sphere's light must be positive");
    }
    pixels += std::numbers::pi * task.radius * task.radius;
  }
  return pixels;
}

std::vector<BallMotion> BallRegistration::launch(DeviceFrames& frames,
                                                 std::span<const BallTask> tasks, bool shaped) {
  if (tasks.empty()) return {};
  cl::Kernel& compiled = kernel(shaped);
  const double pixels = checked_pixels(frames, tasks);
  const SplineFrames& splines =
      frames.splines(options_.spline_degree, options_.presmooth_sigma_px, tiling_);
  if (mask_.size() == 0) write_mask();
  const double each = pixels / static_cast<double>(tasks.size());
  const std::size_t most = engine_.at_once(tasks.size(), each);
  const std::vector<cl_int2> corners = corners_of(frames);
  corners_.reserve(engine_, corners.size());
  tasks_.reserve(engine_, most);
  motions_.reserve(engine_, most);
  BallLimits limits{};
  limits.width = splines.width();
  limits.height = splines.height();
  limits.pitch = splines.pitch();
  limits.plane_pitch = splines.plane_pitch();
  limits.max_steps = options_.max_steps;
  limits.robust = options_.robust ? 1 : 0;
  limits.grey_level = static_cast<float>(frames.full_scale() / 255);
  limits.min_contrast = static_cast<float>(options_.min_texture * frames.full_scale() / 255);
  limits.min_correlation = static_cast<float>(options_.min_correlation);
  limits.mask_area = mask_area_;
  limits.mask_pitch = is_masked() ? options_.mask->width() : 0;
  opencl::set_arguments(compiled, splines.coefficients().get(), splines.coefficient_offset(),
                        splines.planes().get(), tasks_.get(), motions_.get(), limits,
                        smooth_taps_.get(), noise_, mask_.get(), corners_.get());
  const auto group = static_cast<std::size_t>(tiling_.group);
  const double taps = options_.spline_degree + 1.0, columns = 5.0 + parameters(options_.model);
  std::vector<BallMotion> motions(tasks.size());
  for (std::size_t first = 0; first < tasks.size(); first += most) {
    const std::size_t count = std::min(most, tasks.size() - first);
    const double area = each * static_cast<double>(count);
    opencl::Settled settled(engine_);
    tasks_.write_later(engine_, tasks.subspan(first, count));
    if (is_masked()) corners_.write_later(engine_, std::span<const cl_int2>(corners));
    // Four steps are typical.
    engine_.launch(engine_.queue(), compiled, cl::NDRange(count * group), cl::NDRange(group),
                   {area * 16, area * 4 * (2 * taps * taps + columns * (columns + 1) + 80)});
    motions_.read(engine_, std::span(motions).subspan(first, count));
    settled.done();
  }
  return motions;
}

}  // namespace impactdic::dic
