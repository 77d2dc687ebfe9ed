// A shot as `track` is asked for it and as its frames show it: an integrated impact with noise, a
// circle whose radius errs by the same in every frame, a ball that is smaller while it is
// compressed, and what a person gives with it.
#pragma once

#include <impactdic/track.h>

#include <algorithm>
#include <random>
#include <vector>

#include "host/run/metres/scale.h"
#include "tests/support/impact_rows.h"

namespace impactdic::testing {

enum class ScaleBy { kDiameter, kRuler, kTarget };

struct FilmedShot {
  FilmedImpact filmed;
  FilmedTruth truth;
  TrackRequest request;  // right, but for the tolerances that it states
  TrackResult result;    // with its rows; `conclude` does the rest

  void conclude() { run::conclude_metres(request, std::nullopt, result); }
};

// The headline figures of a shot that was concluded: `add(name, found, truth)` for each.
template <typename Add>
void each_figure(const FilmedShot& shot, Add add) {
  const ImpactFigures& found = shot.result.impact_si;
  const FilmedTruth& truth = shot.truth;
  add("vt before", found.before.vt, truth.before.vt_m_s);
  add("vn before", found.before.vn, truth.before.vn_m_s);
  add("vt after", found.after.vt, truth.after.vt_m_s);
  add("vn after", found.after.vn, truth.after.vn_m_s);
  add("spin after", found.after.spin, truth.after.omega_rad_s);
  add("restitution", found.restitution, truth.restitution);
  add("friction", found.friction, truth.friction);
  add("deflection", found.max_deflection_m, truth.deflection_px * shot.filmed.metre_per_px);
}

struct Tolerances {
  double radius_sd_px = 0.02;    // of the clip's radius
  double diameter_sd_mm = 0.03;  // of the ball's
  double ruler_sd = 5e-4;        // of millimetres a pixel, relative
  double angle_sd_deg = 0.03;    // of the surface
  // Free flight before and after the contact, frames.
  int fewest_frames = 40, most_frames = 120;
};

// The picture in which a target tells the scale (support/camera/shot_by_target.h).
inline constexpr int kTargetPictureWidth = 400, kTargetPictureHeight = 300;

// What the ball covers, px.
struct BallBox {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
};
inline BallBox ball_box(const std::vector<TrackRow>& rows) {
  BallBox box;
  for (const TrackRow& row : rows) {
    box.left = std::min(box.left, row.cx_px - row.r_px);
    box.right = std::max(box.right, row.cx_px + row.r_px);
    box.top = std::min(box.top, row.cy_px - row.r_px);
    box.bottom = std::max(box.bottom, row.cy_px + row.r_px);
  }
  return box;
}

// Metres a pixel with which the shot fills `share` of a target's picture.
inline double scale_to_fill(const FilmedImpact& filmed, double share) {
  std::vector<TrackRow> rows;
  film(filmed, rows);
  const BallBox box = ball_box(rows);
  return filmed.metre_per_px * std::max(box.width() / (share * kTargetPictureWidth),
                                        box.height() / (share * kTargetPictureHeight));
}

// Any of the two balls, at any surface, speed, framing and frame rate, by `random`.
inline FilmedShot filmed_shot(std::mt19937_64& random, ScaleBy by, const Tolerances& t = {}) {
  std::uniform_real_distribution<double> part(0, 1);
  std::normal_distribution<double> normal(0, 1);
  FilmedShot shot;
  FilmedImpact& f = shot.filmed = part(random) < 0.5 ? tennis_on_racket() : lacrosse_on_wood();
  f.seed = static_cast<unsigned>(random());
  f.touch = part(random);
  const int more = t.most_frames - t.fewest_frames;
  f.frames_before = t.fewest_frames + static_cast<int>(more * part(random));
  f.metre_per_px = (0.2 + 0.3 * part(random)) * 1e-3;
  f.job.surface_angle_deg = -50 + 100 * part(random);
  if (std::abs(f.job.surface_angle_deg) < 8) f.job.surface_angle_deg = 12;
  const double side = f.job.surface_angle_deg > 0 ? -1 : 1;
  f.job.initial.vn_m_s *= 0.7 + 0.8 * part(random);
  f.job.initial.vt_m_s = side * (0.3 + 1.2 * part(random));
  f.job.initial.omega_rad_s = 10 * (part(random) - 0.5);
  f.frames = f.frames_before + t.fewest_frames + static_cast<int>(more * part(random)) +
             static_cast<int>(sim::contact::simulate_impact(f.job).contact_s * f.fps);
  if (by == ScaleBy::kTarget) f.metre_per_px = scale_to_fill(f, 0.55 + 0.3 * part(random));
  shot.truth = film(f, shot.result.rows);
  const double off = t.radius_sd_px * normal(random);
  for (TrackRow& row : shot.result.rows) {
    const double at = static_cast<double>(row.frame);
    const double in = (at - shot.truth.start) / (shot.truth.end - shot.truth.start);
    if (in > 0 && in < 1) row.r_px -= shot.truth.deflection_px * in * (1 - in);
    row.r_px += off + t.radius_sd_px / 4 * normal(random);
    row.r_sd_px = t.radius_sd_px * 1.03;
  }
  TrackRequest& request = shot.request;
  request.surface_angle_deg = f.job.surface_angle_deg + t.angle_sd_deg * normal(random);
  request.surface_angle_sd_deg = t.angle_sd_deg;
  request.inertia_factor = f.job.body.inertia_factor();
  if (by == ScaleBy::kDiameter) {
    request.ball_diameter_mm = 1e3 * f.job.body.diameter_m + t.diameter_sd_mm * normal(random);
    request.ball_diameter_sd_mm = t.diameter_sd_mm;
  } else if (by == ScaleBy::kRuler) {
    request.mm_per_px = 1e3 * f.metre_per_px * (1 + t.ruler_sd * normal(random));
    request.mm_per_px_sd = t.ruler_sd * request.mm_per_px;
  }
  shot.result.scale.fps = f.fps;
  shot.result.scale.surface_angle_rad = request.surface_angle_deg * kRadPerDeg;
  shot.result.scale.image_height = 512;
  return shot;
}

}  // namespace impactdic::testing
