// From rows in pixels to figures in SI: the scale and its part in every deviation, and what is said
// where something given cannot be true.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "host/run/metres/contradictions.h"
#include "tests/support/filmed_shot.h"

namespace impactdic::testing {
namespace {

// IMPACTDIC_SHOTS=400 settles a coverage to 1.1 % (one deviation).
const int kShots = [] {
  const char* wanted = std::getenv("IMPACTDIC_SHOTS");
  return wanted != nullptr ? std::atoi(wanted) : 120;
}();
constexpr double kNormal95 = 1.959964;

// How often the 95 % intervals of each figure hold the truth.
std::map<std::string, double> coverage(ScaleBy by) {
  std::mt19937_64 random(by == ScaleBy::kDiameter ? 4711 : 4712);
  std::map<std::string, int> inside;
  for (int i = 0; i < kShots; ++i) {
    FilmedShot shot = filmed_shot(random, by);
    shot.conclude();
    const ImpactFigures& found = shot.result.impact_si;
    EXPECT_EQ(found.status, ImpactStatus::kFound) << "shot " << i;
    EXPECT_TRUE(found.contradictions.empty()) << found.contradictions[0].message << ", shot " << i;
    const auto add = [&](const char* name, const Measured& m, double truth) {
      inside[name] += std::abs(m.value - truth) <= kNormal95 * m.sd;
    };
    each_figure(shot, add);
    add("closing inertia", found.closure.inertia_factor, shot.filmed.job.body.inertia_factor());
    add("surface", found.surface_angle_deg, shot.filmed.job.surface_angle_deg);
  }
  std::map<std::string, double> share;
  for (const auto& [name, count] : inside) {
    share[name] = count / static_cast<double>(kShots);
    std::printf("%-16s %.1f %%\n", name.c_str(), 100 * share[name]);
  }
  return share;
}

// Chance alone moves each by sqrt(0.95 * 0.05 / shots); all together may not be off by 2 %.
void expect_honest(const std::map<std::string, double>& shares) {
  const double chance = std::sqrt(0.95 * 0.05 / kShots);
  double sum = 0;
  for (const auto& [name, share] : shares) {
    EXPECT_GE(share, 0.95 - 3 * chance) << name;
    sum += share;
  }
  EXPECT_NEAR(sum / static_cast<double>(shares.size()), 0.95, 0.02);
}

TEST(Metres, IntervalsHoldWithTheScaleByTheDiameter) {
  expect_honest(coverage(ScaleBy::kDiameter));
}

TEST(Metres, IntervalsHoldWithTheScaleByARuler) { expect_honest(coverage(ScaleBy::kRuler)); }

TEST(Metres, TheScaleIsThatOfTheFlights) {
  std::mt19937_64 random(3);
  FilmedShot shot = filmed_shot(random, ScaleBy::kDiameter);
  const auto about = [&](std::int64_t first, std::int64_t end) {  // mostly compressed frames
    FilmedShot part = shot;
    part.result.rows.assign(shot.result.rows.begin() + first, shot.result.rows.begin() + end);
    part.conclude();
    return part.result.scale;
  };
  const auto start = static_cast<std::int64_t>(shot.truth.start);
  const auto end = static_cast<std::int64_t>(shot.truth.end);
  const SiScale whole = about(0, static_cast<std::int64_t>(shot.result.rows.size()));
  const SiScale narrow = about(start - 12, end + 13);
  EXPECT_NEAR(whole.metre_per_px, shot.filmed.metre_per_px, 3 * whole.metre_per_px_sd);
  EXPECT_NEAR(narrow.metre_per_px, shot.filmed.metre_per_px, 3 * narrow.metre_per_px_sd);
  EXPECT_GT(whole.metre_per_px_sd, 0);
  EXPECT_LT(narrow.metre_per_px_sd, 2e-3 * narrow.metre_per_px);
}

TEST(Metres, RowsHoldTheScalesDeviation) {
  TrackRow row;
  row.motion_ok = true;
  row.dx_px = 2, row.dy_px = 0, row.rot_deg = 1;
  row.dx_sd_px = row.dy_sd_px = 0.001, row.rot_sd_deg = 0.001;
  SiScale scale;
  scale.metre_per_px = 1e-3, scale.metre_per_px_sd = 1e-5, scale.fps = 1000, scale.fps_sd = 2;
  const SiRow si = to_si(row, scale);
  EXPECT_NEAR(si.vx_m_s, 2, 1e-12);
  EXPECT_NEAR(si.vx_sd_m_s, std::hypot(0.001, 2 * 0.01, 2 * 0.002), 1e-12);
  EXPECT_NEAR(si.vy_sd_m_s, 0.001, 1e-12);
  EXPECT_NEAR(si.omega_sd_rad_s, kRadPerDeg * 1000 * std::hypot(0.001, 0.002), 1e-9);
  row.periods = 2;  // a frame is missing in between
  EXPECT_NEAR(to_si(row, scale).vx_m_s, 1, 1e-12);
}

// What a person may do wrong, and the words by which it must be known again ("" : any).
struct Slip {
  const char* what;
  std::function<void(FilmedShot&)> make;
};

const Slip kSlips[] = {
    {"surface_angle", [](FilmedShot& s) { s.request.surface_angle_deg = 0; }},
    {"surface_angle", [](FilmedShot& s) { s.request.surface_angle_deg *= -1; }},
    {"surface_angle",
     [](FilmedShot& s) { s.request.surface_angle_deg = 90 - s.request.surface_angle_deg; }},
    {"surface_angle", [](FilmedShot& s) { s.request.surface_angle_deg += 1; }},
    {"inertia_factor",
     [](FilmedShot& s) {
       s.request.inertia_factor = s.request.inertia_factor > 0.5 ? 0.4 : 2.0 / 3;
     }},
    {"gravity", [](FilmedShot& s) { s.request.ball_diameter_mm *= 1e-3; }},
    {"gravity", [](FilmedShot& s) { s.request.ball_diameter_mm *= 0.1; }},
    {"gravity", [](FilmedShot& s) { s.request.ball_diameter_mm /= 25.4; }},
    {"gravity", [](FilmedShot& s) { s.request.ball_diameter_mm *= 0.5; }},
    {"gravity", [](FilmedShot& s) { s.result.scale.fps *= 0.1; }},
    {"gravity", [](FilmedShot& s) { s.result.scale.fps *= 10; }},
    {"gravity", [](FilmedShot& s) { s.result.scale.fps = 30; }},
    {"gravity", [](FilmedShot& s) { s.request.gravity_angle_deg = 90; }},
    {"gravity_angle", [](FilmedShot& s) { s.request.gravity_angle_deg = 0; }},
    {"gravity_angle", [](FilmedShot& s) { s.request.gravity_angle_deg = -180; }},
    {"surface_angle",
     [](FilmedShot& s) {  // axes swapped
       for (TrackRow& r : s.result.rows) {
         std::swap(r.cx_px, r.cy_px), std::swap(r.dx_px, r.dy_px), r.rot_deg *= -1;
       }
     }},
    {"drop_height", [](FilmedShot& s) { s.request.drop_height_mm = 1; }},
};

// Slips shot by shot, each at random surfaces, speeds and framings.
TEST(Metres, NoSlipIsSilent) {
  std::mt19937_64 random(97);
  int silent = 0, unnamed = 0, count = 0;
  std::map<std::string, int> missed;
  for (int i = 0; count < kShots; ++i) {
    for (std::size_t k = 0; k < std::size(kSlips) && count < kShots; ++k, ++count) {
      const FilmedShot right = filmed_shot(random, ScaleBy::kDiameter);
      FilmedShot slipped = right;
      kSlips[k].make(slipped);
      slipped.result.scale.surface_angle_rad = slipped.request.surface_angle_deg * kRadPerDeg;
      slipped.conclude();
      const ImpactFigures& found = slipped.result.impact_si;
      const bool warned = !found.contradictions.empty();
      unnamed += !run::contradicts(found, kSlips[k].what);
      if (warned) continue;
      ++silent;
      ++missed[std::to_string(k) + " " + kSlips[k].what];
    }
  }
  for (const auto& [slip, times] : missed) {
    std::printf("silent: %s, %d times\n", slip.c_str(), times);
  }
  std::printf("%d slips, %d silent, %d under another name\n", count, silent, unnamed);
  EXPECT_EQ(silent, 0);
  EXPECT_LE(unnamed, count / 5);
}

TEST(Metres, RightShotsAreNotWarnedOf) {
  std::mt19937_64 random(2024);
  int warned = 0;
  for (int i = 0; i < kShots; ++i) {
    FilmedShot shot = filmed_shot(random, i % 2 == 0 ? ScaleBy::kDiameter : ScaleBy::kRuler);
    const double speed = std::hypot(shot.truth.before.vt_m_s, shot.truth.before.vn_m_s);
    shot.request.drop_height_mm = 1e3 * speed * speed / (2 * 9.81);
    shot.conclude();
    for (const Contradiction& c : shot.result.impact_si.contradictions) {
      std::printf("shot %d, %g deg: %s\n", i, shot.filmed.job.surface_angle_deg, c.message.c_str());
      ++warned;
    }
  }
  EXPECT_EQ(warned, 0);
}

TEST(Metres, TheMessageNamesTheSlip) {
  std::mt19937_64 random(5);
  const FilmedShot right = filmed_shot(random, ScaleBy::kDiameter);
  const auto said = [&](const std::function<void(FilmedShot&)>& slip) {
    FilmedShot shot = right;
    slip(shot);
    shot.result.scale.surface_angle_rad = shot.request.surface_angle_deg * kRadPerDeg;
    shot.conclude();
    std::string all;
    for (const Contradiction& c : shot.result.impact_si.contradictions) all += c.message + "\n";
    return all;
  };
  const auto expect = [&](const std::string& text, const char* words) {
    EXPECT_NE(text.find(words), std::string::npos) << words << ", not: " << text;
  };
  expect(said([](FilmedShot& s) { s.request.surface_angle_deg = 0; }), "forgotten");
  expect(said([](FilmedShot& s) { s.request.surface_angle_deg *= -1; }), "wrong sign");
  expect(said([](FilmedShot& s) { s.request.ball_diameter_mm *= 1e-3; }), "diameter in m?");
  expect(said([](FilmedShot& s) { s.request.ball_diameter_mm *= 0.1; }), "diameter in cm?");
  expect(said([](FilmedShot& s) { s.request.ball_diameter_mm *= 0.5; }), "radius instead");
  expect(said([](FilmedShot& s) { s.result.scale.fps *= 0.1; }), "a tenth");
  expect(said([](FilmedShot& s) { s.request.gravity_angle_deg = 90; }), "the other way");
  expect(said([](FilmedShot& s) { s.request.gravity_angle_deg += 90; }), "axes swapped");
}

TEST(Metres, DoubtfulAreTheFiguresConcerned) {
  std::mt19937_64 random(6);
  FilmedShot shot = filmed_shot(random, ScaleBy::kDiameter);
  shot.request.surface_angle_deg = 0;
  shot.result.scale.surface_angle_rad = 0;
  shot.conclude();
  const ImpactFigures& found = shot.result.impact_si;
  EXPECT_TRUE(found.is_doubtful(ImpactFigure::kRestitution));
  EXPECT_TRUE(found.is_doubtful(ImpactFigure::kVnAfter));
  EXPECT_FALSE(found.is_doubtful(ImpactFigure::kVxAfter));
  EXPECT_FALSE(found.is_doubtful(ImpactFigure::kSpinAfter));
}

// Every part of a deviation against the whole chain, run again with what the part stands for
// changed: the analysis, the scale and the conversion.
TEST(Metres, BudgetsAreTheSlopesOfTheWholeChain) {
  std::mt19937_64 random(11);
  const FilmedShot right = filmed_shot(random, ScaleBy::kDiameter);
  const auto figures = [&](const std::function<void(FilmedShot&)>& change) {
    FilmedShot shot = right;
    change(shot);
    shot.result.scale.surface_angle_rad = shot.request.surface_angle_deg * kRadPerDeg;
    shot.conclude();
    return shot.result.impact_si;
  };
  const auto compare = [&](ErrorSource source, double sd, double step,
                           const std::function<void(FilmedShot&, double)>& change) {
    const ImpactFigures at = figures([](FilmedShot&) {});
    const ImpactFigures plus = figures([&](FilmedShot& s) { change(s, step); });
    const ImpactFigures minus = figures([&](FilmedShot& s) { change(s, -step); });
    const auto one = [&](ImpactFigure which, const Measured& up, const Measured& down,
                         double whole_sd) {
      const double slope = std::abs(up.value - down.value) / (2 * step) * sd;
      const double part = at.budget(which)[static_cast<std::size_t>(source)];
      // 1 % of the part, or what does not count in the whole.
      EXPECT_NEAR(part, slope, 0.01 * slope + 0.002 * whole_sd)
          << to_string(which) << ", " << to_string(source);
    };
    one(ImpactFigure::kVtBefore, plus.before.vt, minus.before.vt, at.before.vt.sd);
    one(ImpactFigure::kVnBefore, plus.before.vn, minus.before.vn, at.before.vn.sd);
    one(ImpactFigure::kVtAfter, plus.after.vt, minus.after.vt, at.after.vt.sd);
    one(ImpactFigure::kVnAfter, plus.after.vn, minus.after.vn, at.after.vn.sd);
    one(ImpactFigure::kRestitution, plus.restitution, minus.restitution, at.restitution.sd);
    one(ImpactFigure::kFriction, plus.friction, minus.friction, at.friction.sd);
    one(ImpactFigure::kMaxDeflection, plus.max_deflection_m, minus.max_deflection_m,
        at.max_deflection_m.sd);
  };
  const ImpactFigures at = figures([](FilmedShot&) {});
  for (const auto& [which, m] : {std::pair{ImpactFigure::kVnAfter, at.after.vn},
                                 std::pair{ImpactFigure::kFriction, at.friction},
                                 std::pair{ImpactFigure::kMaxDeflection, at.max_deflection_m}}) {
    double squares = 0;
    for (const double part : at.budget(which)) squares += part * part;
    EXPECT_NEAR(std::sqrt(squares), m.sd, 1e-9 * m.sd) << to_string(which);
  }
  FilmedShot scaled = right;
  scaled.conclude();
  const double relative = scaled.result.scale.metre_per_px_sd / scaled.result.scale.metre_per_px;
  compare(ErrorSource::kScale, relative, 1e-4,
          [](FilmedShot& s, double by) { s.request.ball_diameter_mm *= 1 + by; });
  compare(ErrorSource::kAngle, right.request.surface_angle_sd_deg, 0.01,
          [](FilmedShot& s, double by) { s.request.surface_angle_deg += by; });
}

}  // namespace
}  // namespace impactdic::testing
