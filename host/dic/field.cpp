#include "host/dic/field.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "host/base/parse.h"
#include "kernels/status.h"

namespace impactdic {
namespace {

// What the kernels write is what the host reads.
constexpr bool is_kernels(WindowStatus status, int of_kernels) {
  return static_cast<int>(status) == of_kernels;
}
static_assert(is_kernels(WindowStatus::kOk, STATUS_OK));
static_assert(is_kernels(WindowStatus::kMasked, STATUS_MASKED));
static_assert(is_kernels(WindowStatus::kNoTexture, STATUS_NO_TEXTURE));
static_assert(is_kernels(WindowStatus::kLowCorrelation, STATUS_LOW_CORRELATION));
static_assert(is_kernels(WindowStatus::kAtSearchEdge, STATUS_AT_SEARCH_EDGE));
static_assert(is_kernels(WindowStatus::kNotConverged, STATUS_NOT_CONVERGED));
static_assert(is_kernels(WindowStatus::kOutOfView, STATUS_OUT_OF_VIEW));

void check_range(double value, double low, double high, const char* what, const char* option) {
  // The negated form also refuses NaN.
  if (!(value >= low && value <= high)) {
    throw InvalidArgument(std::string(what) + " must be between " + shortest(low) + " and " +
                              shortest(high) + ", not " + shortest(value),
                          option);
  }
}

}  // namespace

const char* to_string(FieldMethod method) {
  switch (method) {
    case FieldMethod::kPublished:
      return "published";
    case FieldMethod::kZncc:
      return "zncc";
    case FieldMethod::kEqual:
      return "equal";
    case FieldMethod::kIcgn:
      return "icgn";
  }
  return "?";
}

FieldMethod parse_field_method(const std::string& name) {
  for (const auto method :
       {FieldMethod::kPublished, FieldMethod::kZncc, FieldMethod::kEqual, FieldMethod::kIcgn}) {
    if (name == to_string(method)) return method;
  }
  throw InvalidArgument("there is no method '" + name + "'", "--method",
                        "published, zncc, equal and icgn exist");
}

void FieldOptions::validate() const {
  check_range(window_px, 5, 129, "the window", "--window");
  check_range(search_px, 1, 128, "the search distance", "--search");
  check_range(interp_points, 0, 9, "the points between pixels", "--interp");
  check_range(max_iterations, 1, 1000, "the iterations", "--max-iterations");
  check_range(min_correlation, 0, 1, "the lowest correlation", "--min-correlation");
  check_range(min_texture, 0, 255, "the lowest contrast", "--min-texture");
  check_range(noise, 0, 255, "the noise", "--noise");
  check_range(max_sd_px, 0.001, 1000, "the largest expected deviation", "--max-sd");
  if (static_cast<unsigned>(method) > static_cast<unsigned>(FieldMethod::kIcgn)) {
    throw InvalidArgument("there is no such method", "--method", "published, zncc and icgn exist");
  }
  if (spline_degree != 3 && spline_degree != 5 && spline_degree != 7) {
    throw InvalidArgument(
        "the spline's degree must be 3, 5 or 7, not " + std::to_string(spline_degree),
        "--spline-degree");
  }
  if (method == FieldMethod::kEqual && window_px != 16 && window_px != 32) {
    throw InvalidArgument("equal windows are 16 or 32 px wide, not " + std::to_string(window_px),
                          "--window", "use --window 32, or --method zncc or icgn");
  }
  // The published method's matrices grow with the cube of the window.
  if (method == FieldMethod::kPublished && window_px > 65) {
    throw InvalidArgument(
        "the published method takes windows of at most 65 px, not " + std::to_string(window_px),
        "--window", "use --method zncc or icgn");
  }
}

const char* to_string(WindowStatus status) {
  static constexpr std::array kNames = {
      "ok",         "masked", "no_texture", "low_correlation", "at_search_edge", "not_converged",
      "out_of_view"};
  const auto index = static_cast<std::size_t>(status);
  return index < kNames.size() ? kNames[index] : "?";
}

}  // namespace impactdic

namespace impactdic::dic {

WindowMotion seed_at(double u_px, double v_px) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  WindowMotion seed{};
  seed.u = static_cast<float>(u_px);
  seed.v = static_cast<float>(v_px);
  seed.correlation = seed.peak_ratio = kNan;
  seed.status = static_cast<idic_int>(WindowStatus::kOk);
  return seed;
}

double pixel_variance(const FieldOptions& options, double full_scale) {
  const double noise = options.noise * full_scale / 255;
  return std::max(noise * noise, 1.0 / 12);
}

}  // namespace impactdic::dic
