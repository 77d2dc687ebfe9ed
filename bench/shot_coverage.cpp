// What a track's impact analysis is worth: errors of each figure over many shots of known truth,
// against the deviations that it states, and how often the 95 % interval holds the truth. Centres
// alone, with and without stated deviations, and centres with measured motions.
//   shot_coverage [COUNT [FIRST [CASE]]]
#include <impactdic/error.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "sim/fit/calibration.h"
#include "tests/support/scratch.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::bench {
namespace {

struct Score {
  double squares = 0, bias = 0, stated = 0, inside = 0, count = 0;
  void add(double value, double sd, double truth, double unit) {
    const double off = (value - truth) * unit;
    if (std::isnan(off)) return;
    squares += off * off, bias += off, stated += sd * unit, ++count;
    inside += std::abs(off) <= 1.959964 * sd * unit;
  }
};

struct Case {
  std::string name;
  testing::SyntheticTrack track;
};

testing::SyntheticTrack ball(double angle_deg, double vt, double vn) {
  testing::SyntheticTrack track;
  track.job.normal = NormalModel::kLinearSpringDamper;
  track.job.friction = vt == 0 ? FrictionModel::kNone : FrictionModel::kCoulomb;
  track.job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  track.job.contact.stiffness = 12526;
  track.job.contact.damping_n_s_per_m = 6.85;
  track.job.contact.friction_kinetic = 0.1;
  track.job.surface_angle_deg = angle_deg;
  track.job.initial.vt_m_s = vt;
  track.job.initial.vn_m_s = vn;
  track.position_noise_m = 20e-6;
  return track;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"normal", ball(0, 0, -3.26)});
  Case next{"oblique", ball(30, -1.6, -2.8)};
  next.track.stated_sd_m = -1;
  all.push_back(next);
  next.name = "clean";
  next.track.position_noise_m = 0;
  all.push_back(next);
  next = {"fine", ball(30, -1.6, -2.8)};
  next.track.position_noise_m = next.track.stated_sd_m = 3e-6;
  all.push_back(next);
  next.name = "motions";
  next.track.motion = true;
  next.track.motion_noise_m = 0.5e-6, next.track.turn_noise_rad = 2e-5;
  all.push_back(next);
  next = {"hertz", ball(20, -0.57, -1.69)};
  next.track.job.normal = NormalModel::kHertzDamper;
  next.track.job.body = {BodyShape::kSolidSphere, 0.14566, 0.06325};
  next.track.job.contact.stiffness = 875000;
  next.track.job.contact.damping_n_s_per_m = 18;
  next.track.position_noise_m = 10e-6;
  all.push_back(next);
  next = {"slow camera", ball(30, -1.6, -2.8)};
  next.track.fps = 2000;
  next.track.frames_before = next.track.frames_after = 40;
  next.track.frames_contact = 15;
  all.push_back(next);
  next.name = "slower camera";
  next.track.fps = 1000;
  next.track.frames_before = next.track.frames_after = 25;
  next.track.frames_contact = 8;
  all.push_back(next);
  // Steps as a ball of 30 px shows them: 0.005 px of 1 mm.
  for (const auto& [name, fps, frames, contact] : {std::tuple{"small ball, 2000/s", 2000, 40, 15},
                                                   {"small ball, 4000/s", 4000, 50, 30},
                                                   {"small ball, 10000/s", 10000, 60, 70},
                                                   {"small ball, 20000/s", 20000, 80, 140}}) {
    next = {name, ball(30, -1.6, -2.8)};
    next.track.motion = true;
    next.track.position_noise_m = next.track.stated_sd_m = 10e-6;
    next.track.motion_noise_m = 5e-6, next.track.turn_noise_rad = 2e-4;
    next.track.fps = fps;
    next.track.frames_before = next.track.frames_after = frames;
    next.track.frames_contact = contact;
    all.push_back(next);
  }
  return all;
}

void add(std::map<std::string, Score>& scores, const testing::SyntheticTrack& track,
         const std::filesystem::path& file) {
  const ImpactJob& job = track.job;
  const ImpactResult truth = sim::contact::simulate_impact(job);
  const MeasuredTrack table = sim::shot::read_track(file);
  MeasuredShot s =
      sim::shot::measure_shot(table, {job.body, job.surface_angle_deg, job.gravity_m_s2});
  const double start = (track.frames_before + track.touch) / track.fps, frames = track.fps;
  const EffectiveFriction friction = sim::contact::effective_friction(
      job.body, truth.start, truth.final, truth.contact_s, job.gravity_m_s2, job.surface_angle_deg);
  const auto put = [&](const char* name, const Measured& e, double right, double unit) {
    scores[name].add(e.value, e.sd, right, unit);
  };
  put("01 start, frames", s.contact_start_s, start, frames);
  put("02 end, frames", s.contact_end_s, start + truth.contact_s, frames);
  put("03 duration, frames", s.contact_s, truth.contact_s, frames);
  put("04 turn, frames", {s.contact_start_s.value + s.t_max_compression_s, 0},
      start + truth.t_max_compression_s, frames);
  put("05 restitution, 1e-3", s.restitution, -truth.final.vn_m_s / truth.start.vn_m_s, 1e3);
  put("06 friction, 1e-3", {s.friction.sound, s.friction_sd}, friction.sound, 1e3);
  put("07 deflection, um", s.max_deflection_m, truth.max_deflection_m, 1e6);
  put("08 vt before, mm/s", s.before.vt_m_s, truth.start.vt_m_s, 1e3);
  put("09 vn before, mm/s", s.before.vn_m_s, truth.start.vn_m_s, 1e3);
  put("10 vt after, mm/s", s.after.vt_m_s, truth.final.vt_m_s, 1e3);
  put("11 vn after, mm/s", s.after.vn_m_s, truth.final.vn_m_s, 1e3);
  put("12 spin after, rad/s", s.after.omega_rad_s, truth.final.omega_rad_s, 1);
  // Both flights carried on: straight lines with the fall taken out.
  const double g = job.gravity_m_s2 * std::cos(job.surface_angle_deg * kRadPerDeg);
  const double end = truth.contact_s, out = truth.final.vn_m_s + g * end;
  const double cross =
      (truth.final.qn_m + g * end * end / 2 - out * end) / (truth.start.vn_m_s - out);
  put("13 crossing depth, um", s.crossing_above_lowest_m,
      truth.start.vn_m_s * cross - g * cross * cross / 2 + truth.max_deflection_m, 1e6);
  put("14 crossing, frames", {s.crossing_s, 0}, start + cross, frames);
  sim::fit::time_contact(s, job);
  put("15 timed start, frames", s.contact_start_s, start, frames);
  put("16 timed duration, frames", s.contact_s, truth.contact_s, frames);
  put("17 timed restitution, 1e-3", s.restitution, -truth.final.vn_m_s / truth.start.vn_m_s, 1e3);
}

void run(unsigned count, unsigned first, const std::string& wanted) {
  const testing::ScratchFolder folder;
  for (const Case& one : cases()) {
    if (!wanted.empty() && one.name != wanted) continue;
    std::map<std::string, Score> scores;
    std::map<std::string, int> refused;
    double seconds = 0;
    const unsigned shots = one.track.position_noise_m > 0 ? count : 10;
    for (unsigned seed = first; seed < first + shots; ++seed) {
      testing::SyntheticTrack track = one.track;
      track.seed = seed;
      track.touch = std::fmod(0.618034 * seed, 1.0);
      track.job.initial.vn_m_s *= 0.8 + 0.4 * std::fmod(0.7548777 * seed, 1.0);
      const auto file = folder / "track.csv";
      write_track(track, file);
      const auto begin = std::chrono::steady_clock::now();
      try {
        add(scores, track, file);
      } catch (const Error& error) {
        ++refused[error.what()];
      }
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    std::printf("%s: %u shots, %.1f ms each\n", one.name.c_str(), shots, 1e3 * seconds / shots);
    for (const auto& [why, times] : refused) std::printf("  refused %d: %s\n", times, why.c_str());
    for (const auto& [name, s] : scores) {
      if (s.count == 0) continue;
      std::printf("  %-28s rms error %9.4f  bias %9.4f  stated %9.4f  inside %5.1f %%  of %.0f\n",
                  name.c_str(), std::sqrt(s.squares / s.count), s.bias / s.count,
                  s.stated / s.count, 100 * s.inside / s.count, s.count);
    }
  }
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  const auto number = [&](int i, unsigned fallback) {
    return argc > i ? static_cast<unsigned>(std::atoi(argv[i])) : fallback;
  };
  impactdic::bench::run(number(1, 100), number(2, 1), argc > 3 ? argv[3] : "");
}
