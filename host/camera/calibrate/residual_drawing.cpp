#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/lens.h"

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;

constexpr std::array kColours = {"#1f77b4", "#ff7f0e", "#2ca02c", "#9467bd",
                                 "#8c564b", "#e377c2", "#17becf", "#bcbd22"};
constexpr double kWide = 900, kMargin = 20, kLine = 18;

template <typename... Values>
std::string say(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else
      safe += c;
  }
  return safe;
}

// A length of 1, 2 or 5 times a power of ten, not above `most`.
double round_length(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= most) return step * power;
  }
  return power;
}

// How the lens bends straight lines, its distortion enlarged so that it is seen.
std::string grid(const CalibrateResult& result, double scale, double enlarged) {
  const Lens lens(result.camera);
  constexpr int kLines = 12, kSteps = 48;
  std::string lines;
  const double w = result.camera.width - 1, h = result.camera.height - 1;
  for (int axis = 0; axis < 2; ++axis) {
    for (int i = 0; i <= kLines; ++i) {
      std::string points;
      for (int k = 0; k <= kSteps; ++k) {
        const double a = static_cast<double>(i) / kLines, b = static_cast<double>(k) / kSteps;
        const Vector2d at = axis == 0 ? Vector2d(a * w, b * h) : Vector2d(b * w, a * h);
        const Vector2d bent = at + enlarged * (at - lens.undistort(at));
        points += say("%.1f,%.1f ", kMargin + scale * bent.x(), kMargin + scale * bent.y());
      }
      lines += "<polyline points=\"" + points + "\" fill=\"none\" stroke=\"#ddd\"/>\n";
    }
  }
  return lines;
}

std::string arrows(const CalibrateResult& result, double scale, double length_a_px) {
  std::string drawn;
  for (const CalibrationPoint& point : result.points) {
    const double x = kMargin + scale * point.x_px, y = kMargin + scale * point.y_px;
    const char* colour = point.used ? kColours[point.picture % kColours.size()] : "#d62728";
    const double dx = length_a_px * point.off_x_px, dy = length_a_px * point.off_y_px;
    const double longest = 60 / std::max(60.0, std::hypot(dx, dy));
    drawn +=
        say("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.5\" fill=\"%s\"/>"
            "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n",
            x, y, colour, x, y, x + longest * dx, y + longest * dy, colour);
  }
  return drawn;
}

std::vector<std::string> words(const CalibrateResult& result, double unit_px, double enlarged) {
  std::vector<std::string> lines;
  lines.push_back(
      say("%zu points in %zu pictures, scatter %.3f px; distortion: %s, at most %.2f px",
          result.points.size(), result.pictures.size(), result.point_sd_px, result.terms.c_str(),
          result.distortion_px));
  lines.push_back(
      say("bar: a residual of %g px; red: left out; grey: straight lines as the lens "
          "bends them, %g times",
          unit_px, enlarged));
  for (const std::string& verdict : result.verdict) lines.push_back(verdict);
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    const CalibrationPicture& picture = result.pictures[i];
    const std::string what =
        picture.used ? say("%zu points, %zu left out, rms %.3f px, tilt %.1f deg", picture.points,
                           picture.rejected, picture.rms_px, picture.tilt_deg)
                     : "not used: " + picture.reason;
    lines.push_back(picture.name + ": " + what);
  }
  return lines;
}

}  // namespace

std::string draw_residuals(const CalibrateResult& result) {
  const double scale = kWide / result.camera.width;
  const double high = scale * result.camera.height;
  const double typical = std::max(result.point_sd_px, 1e-6);
  const double length_a_px = 12 / typical;  // of an arrow
  const double unit_px = round_length(60 / length_a_px);
  const double enlarged =
      result.distortion_px > 1e-6 ? round_length(std::max(1.0, 20 / result.distortion_px)) : 1;
  const std::vector<std::string> lines = words(result, unit_px, enlarged);
  const double tall = high + 3 * kMargin + kLine * (static_cast<double>(lines.size()) + 1);
  std::string svg =
      say("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
          "font-family=\"sans-serif\" font-size=\"13\">\n"
          "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n"
          "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" "
          "stroke=\"black\"/>\n",
          kWide + 2 * kMargin, tall, kMargin, kMargin, kWide, high);
  svg += grid(result, scale, enlarged) + arrows(result, scale, length_a_px);
  double y = high + 2 * kMargin;
  svg +=
      say("<line x1=\"%.0f\" y1=\"%.0f\" x2=\"%.1f\" y2=\"%.0f\" stroke=\"black\" "
          "stroke-width=\"3\"/>\n",
          kMargin, y, kMargin + unit_px * length_a_px, y);
  for (const std::string& line : lines) {
    y += kLine;
    svg += say("<text x=\"%.0f\" y=\"%.0f\">", kMargin, y) + escaped(line) + "</text>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace impactdic::camera
