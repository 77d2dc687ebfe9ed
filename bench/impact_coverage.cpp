// What the analysis finds of impacts of every law of contact: balls of 25 to 120 px, steps known to
// 0.0005 to 0.01 px, contacts of 4 to 150 frames, all drawn at random. Of each law how many are
// found, and of each figure the median error and how errors compare with the deviations that are
// stated.
//   impact_coverage [COUNT [FIRST]]
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "host/base/statistics.h"
#include "tests/support/impact_rows.h"
#include "tests/support/random_shots.h"

namespace impactdic::bench {
namespace {

using testing::FilmedImpact;
using testing::FilmedTruth;

struct Figure {
  std::vector<double> errors, ratios;
  void add(const Measured& found, double truth) {
    if (!std::isfinite(found.value) || !std::isfinite(truth)) return;
    errors.push_back(std::abs(found.value - truth));
    ratios.push_back(errors.back() / found.sd);
  }
  void print(const char* name) const {
    if (errors.empty()) return;
    const auto count = static_cast<double>(ratios.size());
    double squares = 0;
    for (const double ratio : ratios) squares += std::min(ratio * ratio, 100.0);
    const auto beyond = [&](double sds) {
      return 100 *
             static_cast<double>(
                 std::count_if(ratios.begin(), ratios.end(), [&](double r) { return r > sds; })) /
             count;
    };
    std::printf("  %-12s median error %9.2g, over sd %5.2f, beyond 2 sd %5.1f %%, 3 sd %5.1f %%\n",
                name, upper_median(errors), std::sqrt(squares / count), beyond(2), beyond(3));
  }
};

struct Law {
  std::map<std::string, int> statuses;
  Figure start, end, restitution, friction, spin, deflection;
};

// Of an impact that a camera shows: 40 frames before the contact and after it.
FilmedImpact filmed(support::RandomShots& random, const support::LawPair& laws) {
  constexpr int kFlight = 40;
  for (;;) {
    FilmedImpact f;
    f.job = random.next(laws);
    const double radius_px = random.decades(std::log10(25.0), std::log10(120.0));
    f.metre_per_px = f.job.body.radius_m() / radius_px;
    const ImpactResult impact = sim::contact::simulate_impact(f.job);
    const double contact_frames = random.decades(0.6, 2.2);
    f.fps = contact_frames / impact.contact_s;
    const double step_px = random.decades(-3.3, -2);
    f.step_noise_m_s = step_px * f.metre_per_px * f.fps;
    f.spin_noise_rad_s = step_px / radius_px * f.fps;
    f.position_noise_px = 3 * step_px;
    f.frames_before = kFlight;
    f.touch = random.between(0, 1);
    f.frames = 2 * kFlight + static_cast<int>(contact_frames) + 2;
    f.seed = static_cast<unsigned>(random.between(0, 1e6));
    // Pressed in by some steps' noise and no more than a ball can be; a rebound that shows; no
    // weight that outlasts the law's force, whose end then is no separation; 30 px a frame are no
    // film.
    const double depth_px = impact.max_deflection_m / f.metre_per_px;
    const double out_px = f.speed(impact.final.vn_m_s);
    const double weighed = f.job.gravity_m_s2 * impact.contact_s / -f.job.initial.vn_m_s;
    if (weighed < 0.01 && depth_px > 20 * step_px && depth_px < 0.25 * radius_px &&
        out_px > 5 * step_px &&
        f.speed(std::hypot(f.job.initial.vn_m_s, f.job.initial.vt_m_s)) < 30) {
      return f;
    }
  }
}

void add(Law& law, const FilmedImpact& f) {
  std::vector<TrackRow> rows;
  const FilmedTruth truth = testing::film(f, rows);
  const ImpactAnalysis found = impact::analyse_impact(rows, f.options());
  ++law.statuses[std::string(to_string(found.status))];
  if (found.status != ImpactStatus::kFound) return;
  law.start.add(found.start.instant, truth.start);
  law.end.add(found.end.instant, truth.end);
  law.restitution.add(found.restitution, truth.restitution);
  law.friction.add({std::abs(found.friction.value), found.friction.sd}, truth.friction);
  law.spin.add(found.after.spin, truth.after.omega_rad_s / f.fps);
  law.deflection.add(found.max_deflection, truth.deflection_px);
}

void run(int count, std::uint32_t first) {
  std::map<std::string, Law> found;
  for (const support::LawPair& laws : support::kSoundLaws) {
    if (laws.second != FrictionModel::kCoulomb && laws.second != FrictionModel::kGripSlip) continue;
    support::RandomShots random(first);
    for (int i = 0; i < count; ++i) {
      add(found[std::string(name_of(laws.first))], filmed(random, laws));
    }
  }
  for (const auto& [name, law] : found) {
    std::printf("%s:", name.c_str());
    for (const auto& [status, times] : law.statuses) std::printf(" %s %d", status.c_str(), times);
    std::printf("\n");
    law.start.print("start");
    law.end.print("end");
    law.deflection.print("deflection");
    law.restitution.print("restitution");
    law.friction.print("friction");
    law.spin.print("spin");
  }
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  const auto number = [&](int i, int fallback) { return argc > i ? std::atoi(argv[i]) : fallback; };
  impactdic::bench::run(number(1, 100), static_cast<std::uint32_t>(number(2, 1)));
}
