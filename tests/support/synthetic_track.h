// A track.csv whose impact is integrated, with noise of a known deviation.
#pragma once

#include <impactdic/units.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "host/base/parse.h"
#include "sim/contact/impact.h"

namespace impactdic::testing {

struct SyntheticTrack {
  ImpactJob job;
  double fps = 10000;
  int frames_before = 100, frames_contact = 75, frames_after = 100;
  double touch = 0.37;          // part of a frame that the touch comes after frame `frames_before`
  double m_per_px = 2.6e-4;     // as section 3.2.1's ball in 512 pixels
  double position_noise_m = 0;  // one standard deviation, each coordinate
  double stated_sd_m = 20e-6;   // written into cx_sd_px, cy_sd_px; < 0: left empty
  bool motion = false;          // dx, dy, rotation with the noise below
  double motion_noise_m = 0, turn_noise_rad = 0;
  unsigned seed = 1;
};

inline const char* track_header() {
  return "frame,time_s,status,cx_px,cy_px,r_px,cx_sd_px,cy_sd_px,r_sd_px,dx_px,dy_px,rot_deg,"
         "dx_sd_px,dy_sd_px,rot_sd_deg,windows,x_m,y_m,vx_m_s,vy_m_s,vt_m_s,vn_m_s,omega_rad_s,"
         "vx_sd_m_s,vy_sd_m_s,omega_sd_rad_s\n";
}

inline void write_track(const SyntheticTrack& s, const std::filesystem::path& file) {
  const int count = s.frames_before + s.frames_contact + s.frames_after;
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back((i - s.frames_before - s.touch) / s.fps);
  const ImpactResult impact = sim::contact::simulate_impact(s.job, {0, times});
  const double angle = s.job.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), n = std::sin(angle);
  std::mt19937_64 random(s.seed);
  std::normal_distribution<double> noise(0, 1);
  const auto text = [](double v) { return shortest(v); };
  std::ofstream out(file);
  out << track_header();
  const auto position = [&](int i, bool vertical) {
    const BodyState& p = impact.trajectory[static_cast<std::size_t>(i)].state;
    const double qn = p.qn_m - p.outline_lag_m;  // what a camera sees
    return vertical ? n * p.qt_m + c * qn : c * p.qt_m - n * qn;
  };
  for (int i = 0; i < count; ++i) {
    const double x = 0.06 + position(i, false) + s.position_noise_m * noise(random);
    const double y = -0.06 + position(i, true) + s.position_noise_m * noise(random);
    const std::string sd = s.stated_sd_m < 0 ? "" : text(s.stated_sd_m / s.m_per_px);
    out << i << ',' << text(i / s.fps) << ",ok," << text(x / s.m_per_px) << ','
        << text(-y / s.m_per_px) << ",128," << sd << ',' << sd << ",0.01,";
    if (s.motion && i + 1 < count) {
      const double dx =
          position(i + 1, false) - position(i, false) + s.motion_noise_m * noise(random);
      const double dy =
          position(i + 1, true) - position(i, true) + s.motion_noise_m * noise(random);
      const double turn = impact.trajectory[static_cast<std::size_t>(i) + 1].state.angle_rad -
                          impact.trajectory[static_cast<std::size_t>(i)].state.angle_rad +
                          s.turn_noise_rad * noise(random);
      const std::string motion_sd = text(std::max(s.motion_noise_m, 1e-7) / s.m_per_px);
      out << text(dx / s.m_per_px) << ',' << text(-dy / s.m_per_px) << ','
          << text(turn * kDegPerRad) << ',' << motion_sd << ',' << motion_sd << ','
          << text(std::max(s.turn_noise_rad, 1e-6) * kDegPerRad) << ",200,";
    } else {
      out << ",,,,,,0,";
    }
    // The velocities of the truth: a calibration takes only the direction of the local axes from
    // them.
    const BodyState& state = impact.trajectory[static_cast<std::size_t>(i)].state;
    out << text(x) << ',' << text(y) << ',' << text(c * state.vt_m_s - n * state.vn_m_s) << ','
        << text(n * state.vt_m_s + c * state.vn_m_s) << ',' << text(state.vt_m_s) << ','
        << text(state.vn_m_s) << ",,,,\n";
  }
}

}  // namespace impactdic::testing
