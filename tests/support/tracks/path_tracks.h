// Tracked rows of balls that meet no surface, and of some that do, with the errors that good and
// poor film make: what a search for impacts must tell apart.
#pragma once

#include <impactdic/units.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/impact_rows.h"

namespace impactdic::testing {

// Errors of a track. A coder of video shifts whole pictures: a step errs by the difference of two
// such shifts, so that steps which follow each other err against each other.
struct FilmErrors {
  double centre_px = 0.01, step_px = 0.003;  // independent from frame to frame, as stated
  double drift_px = 0;                       // shift of a picture, alike in frames near each other
  double predicted_px = 0;                   // shift of each second picture
  double turn_rad = 6e-6;

  static FilmErrors camera(double size) { return {0.01 * size, 0.003 * size, 0, 0, 6e-6 * size}; }
  static FilmErrors coder(double size) {
    return {0.03 * size, 0.002 * size, 0.03 * size, 0.06 * size, 2e-4 * size};
  }
};

// Adds errors to rows that are exact.
inline void add_errors(const FilmErrors& errors, std::mt19937_64& random,
                       std::vector<TrackRow>& rows) {
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> part(0, 1);
  constexpr double kAlike = 0.8;
  std::array<std::vector<double>, 2> shift;
  for (std::vector<double>& s : shift) {
    double drift = normal(random);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      drift = kAlike * drift + std::sqrt(1 - kAlike * kAlike) * normal(random);
      s.push_back(errors.drift_px * drift + (i % 2) * errors.predicted_px * 2 * part(random));
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    row.cx_px += shift[0][i] + errors.centre_px * normal(random);
    row.cy_px += shift[1][i] + errors.centre_px * normal(random);
    row.cx_sd_px = row.cy_sd_px = row.r_sd_px = errors.centre_px;
    if (!row.motion_ok) continue;
    row.dx_px += shift[0][i + 1] - shift[0][i] + errors.step_px * normal(random);
    row.dy_px += shift[1][i + 1] - shift[1][i] + errors.step_px * normal(random);
    row.dx_sd_px = row.dy_sd_px = errors.step_px;
    row.rot_deg += errors.turn_rad * kDegPerRad * normal(random);
    row.rot_sd_deg = errors.turn_rad * kDegPerRad;
  }
}

using Path = std::function<std::array<double, 2>(double)>;  // x, y up, px, at a frame

// Exact rows of a ball on a path.
inline std::vector<TrackRow> rows_of(const Path& path, int frames, double spin_rad) {
  std::vector<TrackRow> rows(static_cast<std::size_t>(frames));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackRow& row = rows[i];
    const auto here = path(static_cast<double>(i)), next = path(static_cast<double>(i + 1));
    row.frame = static_cast<std::int64_t>(i);
    row.time_s = static_cast<double>(i) / 1000;
    row.status = TrackStatus::kOk;
    row.circle_ok = true;
    row.cx_px = 256 + here[0], row.cy_px = 256 - here[1], row.r_px = 60;
    if (i + 1 == rows.size()) break;
    row.motion_ok = true;
    row.dx_px = next[0] - here[0], row.dy_px = here[1] - next[1];
    row.rot_deg = spin_rad * kDegPerRad;
    row.windows = 200;
  }
  return rows;
}

// Takes the motions away, as `--no-field` leaves them.
inline void without_motion(std::vector<TrackRow>& rows) {
  for (TrackRow& row : rows) {
    row.motion_ok = false;
    row.dx_px = row.dy_px = row.rot_deg = kNotMeasured;
  }
}

enum class FreePath { kCircle, kThrow, kRoll, kSwing, kHand, kRelease, kLine };
inline constexpr std::array kFreePaths = {FreePath::kCircle, FreePath::kThrow, FreePath::kRoll,
                                          FreePath::kSwing,  FreePath::kHand,  FreePath::kRelease,
                                          FreePath::kLine};
inline const char* name_of(FreePath path) {
  constexpr std::array kNames = {"circle", "throw", "roll", "swing", "hand", "release", "line"};
  return kNames[static_cast<std::size_t>(path)];
}

// A track without an impact, and what is known about it.
struct FreeTrack {
  std::vector<TrackRow> rows;
  impact::ImpactOptions options;
};

inline Path free_path(FreePath kind, int frames, double gravity, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1);
  const auto between = [&](double low, double high) { return low + (high - low) * part(random); };
  const double size = between(20, 150), phase = between(0, 2 * kPi), vx = between(-2, 2);
  const double rate = 2 * kPi / (frames * between(0.25, 2));
  const double middle = frames * between(0.2, 0.8), vy = between(-2, 2);
  const double ratio = between(1.3, 3.7), other = between(0, 2 * kPi);
  switch (kind) {
    case FreePath::kCircle:
      return [=](double t) {
        return std::array{size * std::cos(rate * t + phase), size * std::sin(rate * t + phase)};
      };
    case FreePath::kThrow:
      return [=](double t) {
        return std::array{vx * t, -gravity * (t - middle) * (t - middle) / 2};
      };
    case FreePath::kRoll:  // slower and slower
      return [=](double t) { return std::array{vx * t * (1 - t / frames / 3), 0.0}; };
    case FreePath::kSwing:  // of a pendulum
      return [=](double t) {
        const double angle = 0.6 * std::sin(rate * t + phase);
        return std::array{2 * size * std::sin(angle), -2 * size * std::cos(angle)};
      };
    case FreePath::kHand:
      return [=](double t) {
        return std::array{
            size * std::sin(rate * t + phase),
            size * (std::sin(rate * t + other) + 0.3 * std::sin(ratio * rate * t + phase))};
      };
    case FreePath::kRelease:  // held, then let go
      return [=](double t) {
        const double fell = std::max(0.0, t - middle);
        return std::array{0.0, -gravity * fell * fell / 2};
      };
    case FreePath::kLine:
      break;
  }
  return [=](double t) { return std::array{vx * t, vy * t}; };
}

// Any surface, known gravity or none, with errors of a camera or of a coder.
inline FreeTrack free_track(FreePath kind, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  FreeTrack track;
  const int frames = 40 + static_cast<int>(260 * part(random));
  const double gravity = 4.0 / frames * part(random);
  const Path path = free_path(kind, frames, gravity, random);
  track.rows = rows_of(path, frames, 0.1 * part(random));
  const double size = std::pow(10, part(random) - 0.5);
  add_errors(part(random) < 0.5 ? FilmErrors::camera(size) : FilmErrors::coder(size), random,
             track.rows);
  if (part(random) < 0.2) without_motion(track.rows);
  track.options.surface_angle_rad = kPi * (2 * part(random) - 1);
  if (part(random) < 0.5) track.options.gravity = gravity;
  return track;
}

// A track with an impact, what is known about it and the truth.
struct ImpactTrack {
  std::vector<TrackRow> rows;
  impact::ImpactOptions options;
  FilmedTruth truth;
  FilmedImpact filmed;
};

// Either ball of the dissertation at 500 to 100 000 frames/s, so that the contact takes from one
// frame to a hundred. Each flight takes 12 to 100 frames and at least half as many as the contact.
inline ImpactTrack impact_track(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  ImpactTrack track;
  FilmedImpact& f = track.filmed = part(random) < 0.5 ? tennis_on_racket() : lacrosse_on_wood();
  f.job.initial.vn_m_s *= 0.7 + 0.8 * part(random);
  f.job.initial.vt_m_s *= 2 * part(random);
  const double contact_s = sim::contact::simulate_impact(f.job).contact_s;
  const double contact = std::pow(10, 2 * part(random));  // frames
  f.fps = contact / contact_s;
  f.metre_per_px = -f.job.initial.vn_m_s / f.fps / (0.5 + 3 * part(random));
  f.touch = part(random);
  const double least = std::max(12.0, contact / 2);
  f.frames_before = static_cast<int>(std::ceil(least + (100 - least) * part(random)));
  const double after = std::ceil(least + (100 - least) * part(random));
  f.frames = f.frames_before + 1 + static_cast<int>(std::ceil(contact + after));
  f.step_noise_m_s = f.spin_noise_rad_s = f.position_noise_px = 0;
  track.truth = film(f, track.rows);
  const double size = std::pow(10, part(random) - 0.5);
  add_errors(part(random) < 0.5 ? FilmErrors::camera(size) : FilmErrors::coder(size), random,
             track.rows);
  if (part(random) < 0.2) without_motion(track.rows);
  track.options = f.options();
  if (part(random) < 0.5) track.options.gravity.reset();
  return track;
}

}  // namespace impactdic::testing
