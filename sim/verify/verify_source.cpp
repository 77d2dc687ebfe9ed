// Rows of `impactdic verify`: the figures that the dissertation prints, in the reading that
// reproduces them, and regression values of the published rules.
#include <cmath>
#include <string>

#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"
#include "sim/verify/verify_cases.h"

namespace impactdic::sim::verify {

namespace {

// Half a unit of the last printed digit.
double half_digit(int decimals) { return 0.5 * std::pow(10.0, -decimals); }

using Figure = double (*)(const ImpactResult&);

double restitution(const ImpactResult& r) { return r.restitution; }
double final_vt(const ImpactResult& r) { return r.final.vt_m_s; }
double final_vn(const ImpactResult& r) { return r.final.vn_m_s; }
double final_omega(const ImpactResult& r) { return r.final.omega_rad_s; }
double final_spin(const ImpactResult& r) { return std::abs(r.final.omega_rad_s); }
double contact_ms(const ImpactResult& r) { return 1e3 * r.contact_s; }
double compression_ms(const ImpactResult& r) { return 1e3 * r.t_max_compression_s; }

double phase_end_ms(const ImpactResult& r, const std::string& name) {
  for (const ContactPhase& phase : r.phases) {
    if (phase.name == name) return 1e3 * phase.end_s;
  }
  return std::nan("");
}
double sliding_end_ms(const ImpactResult& r) { return phase_end_ms(r, "sliding"); }
double sticking_end_ms(const ImpactResult& r) { return phase_end_ms(r, "sticking"); }

void add(std::vector<VerifyCase>& cases, const std::string& group, const std::string& name,
         const std::string& source, double expected, double tolerance, const ImpactJob& job,
         Figure figure) {
  cases.push_back({group, name, source, expected, tolerance,
                   [job, figure] { return figure(contact::simulate_impact(job)); }});
}

void add_racket(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on a racket, 15 deg, 2 m/s";
  const ImpactJob job = job::racket_job();
  add(cases, group, "time of maximum compression, ms", "printed 3.1", 3.068, half_digit(3), job,
      compression_ms);
  add(cases, group, "normal velocity after, m/s", "printed 1.67", 1.6694, half_digit(4), job,
      final_vn);
  add(cases, group, "restitution", "printed 0.86", 0.8642, half_digit(4), job, restitution);
  add(cases, group, "force at maximum compression, N", "section 3.1.3", 46.53, half_digit(2), job,
      [](const ImpactResult& r) { return r.max_force_n; });
  add(cases, group, "maximum deflection, mm", "section 3.1.3", 3.476, half_digit(3), job,
      [](const ImpactResult& r) { return 1e3 * r.max_deflection_m; });
  add(cases, group, "contact duration, ms", "section 3.1.3", 6.325, half_digit(3), job, contact_ms);
  cases.push_back(
      {group, "force at the first touch, N", "section 3.1.3", 10.355, half_digit(3), [job] {
         const double touch_s = 0;
         const contact::Recording at_touch{.times_s = std::span(&touch_s, 1)};
         return contact::simulate_impact(job, at_touch).trajectory[0].normal_force_n;
       }});
  ImpactJob damped = job;
  damped.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  add(cases, group, "damped to zero deflection: final force, N", "printed \"negative\"", -7.58,
      half_digit(2), damped, [](const ImpactResult& r) { return r.separation_force_n; });
  add(cases, group, "damped to zero deflection: restitution", "section 3.1.3", 0.7322,
      half_digit(4), damped, restitution);
}

void add_racket_oblique(std::vector<VerifyCase>& cases) {
  // Before, measured after (for the friction of Eq. 3.12), and our figures.
  struct Row {
    double angle_deg, vt, vn, measured_vt, measured_vn, expected_vt, expected_vn;
  };
  for (const Row& row : {Row{15, -0.57, -2.50, -0.41, 2.27, -0.428, 2.161},
                         Row{30, -1.81, -3.52, -1.10, 3.13, -1.134, 3.045},
                         Row{45, -2.68, -2.96, -1.68, 2.63, -1.728, 2.561},
                         Row{57, -2.61, -1.73, -1.55, 1.59, -1.621, 1.496}}) {
    ImpactJob job = job::racket_job();
    job.surface_angle_deg = row.angle_deg;
    job.initial.vt_m_s = row.vt;
    job.initial.vn_m_s = row.vn;
    job.contact.friction_kinetic = (row.measured_vt - row.vt) / (row.measured_vn - row.vn);
    const std::string group =
        "ball on a racket, oblique " + std::to_string(static_cast<int>(row.angle_deg)) + " deg";
    add(cases, group, "tangential velocity after, m/s", "section 3.3.2", row.expected_vt,
        half_digit(3), job, final_vt);
    add(cases, group, "normal velocity after, m/s", "section 3.3.2", row.expected_vn, half_digit(3),
        job, final_vn);
  }
}

void add_wood_regression(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on wood, published rule, 20 deg";
  ImpactJob job = job::wood_published_job();
  const auto regression = [&](const char* name, double value, Figure figure) {
    add(cases, group, name, "regression", value, 1e-6 * std::abs(value), job, figure);
  };
  regression("sliding ends, ms (printed 2.08)", 2.161047, sliding_end_ms);
  regression("maximum compression, ms", 2.771607, compression_ms);
  regression("sticking ends, ms (printed 3.31)", 3.386298, sticking_end_ms);
  regression("contact duration, ms", 5.656875, contact_ms);
  regression("tangential velocity, m/s (printed 0.26)", 0.277590, final_vt);
  regression("spin, rad/s (printed 22.1)", -21.615015, final_omega);
  add(cases, group, "sticking feeds energy in: warnings", "energy audit", 1, 0, job,
      [](const ImpactResult& r) { return static_cast<double>(r.warnings.size()); });
  job.friction = FrictionModel::kFullSliding;
  add(cases, group, "full sliding: tangential velocity, m/s", "printed 0.01", 0.021, half_digit(3),
      job, final_vt);
  add(cases, group, "full sliding: spin, rad/s", "printed 41.2", 41.9, half_digit(1), job,
      final_spin);
  job.friction = FrictionModel::kBrody;
  // Rolling from the exact event on; a run that notices it 3 us late ends at 0.401 and 12.75.
  add(cases, group, "Brody: tangential velocity, m/s", "printed 0.40", 0.401, 0.0015, job,
      final_vt);
  add(cases, group, "Brody: spin, rad/s", "printed 12.55", 12.75, 0.05, job, final_spin);
}

// The initial velocities are not printed; those chosen fit within about 4 %.
void add_wood_steeper(std::vector<VerifyCase>& cases) {
  struct Row {
    double angle_deg, vt, vn;
    FrictionModel friction;
    double printed_vt, printed_spin;
  };
  const auto rows = {Row{30, 0.87, -1.87, FrictionModel::kThreePhase, 0.49, 29.1},
                     Row{30, 0.87, -1.87, FrictionModel::kFullSliding, 0.06, 60.1},
                     Row{30, 0.87, -1.87, FrictionModel::kBrody, 0.62, 19.4},
                     Row{40, 1.13, -1.85, FrictionModel::kThreePhase, 0.71, 31.1},
                     Row{40, 1.13, -1.85, FrictionModel::kFullSliding, 0.12, 73.8},
                     Row{40, 1.13, -1.85, FrictionModel::kBrody, 0.80, 25.1}};
  for (const Row& row : rows) {
    ImpactJob job = job::wood_published_job();
    job.surface_angle_deg = row.angle_deg;
    job.initial.vt_m_s = row.vt;
    job.initial.vn_m_s = row.vn;
    job.friction = row.friction;
    const std::string group =
        "ball on wood, published rule, " + std::to_string(static_cast<int>(row.angle_deg)) + " deg";
    const std::string model(name_of(row.friction));
    add(cases, group, model + ": tangential velocity, m/s", "printed", row.printed_vt,
        0.035 * std::abs(row.vt), job, final_vt);
    add(cases, group, model + ": spin, rad/s", "printed", row.printed_spin, 0.02 * row.printed_spin,
        job, final_spin);
  }
}

// When the tangential force turns, ms.
double reversal_ms(const ImpactJob& job) {
  const auto path = contact::simulate_impact(job, {.rate_hz = 1e6}).trajectory;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (path[i - 1].tangential_force_n < 0 && path[i].tangential_force_n >= 0) {
      return 1e3 * path[i].time_s;
    }
  }
  return std::nan("");
}

void add_wood_sound(std::vector<VerifyCase>& cases) {
  // Figures of a run with discrete springs; the limit of many springs differs by up to 6e-4 m/s.
  struct Row {
    double angle_deg, vt, vn, expected_vt, expected_spin, expected_reversal_ms;
  };
  for (const Row& row :
       {Row{20, 0.57, -1.69, 0.366, 17.7, 3.60}, Row{30, 0.877, -1.60, 0.539, 29.0, 3.67},
        Row{40, 1.135, -1.60, 0.678, 39.0, 3.69}}) {
    ImpactJob job = job::wood_sound_job();
    job.surface_angle_deg = -row.angle_deg;
    job.initial.vt_m_s = row.vt;
    job.initial.vn_m_s = row.vn;
    const std::string group = "ball on wood, Maw-Barber-Fawcett, " +
                              std::to_string(static_cast<int>(row.angle_deg)) + " deg";
    add(cases, group, "tangential velocity after, m/s", "measured 0.31, 0.46, 0.59",
        row.expected_vt, 1e-3, job, final_vt);
    add(cases, group, "spin after, rad/s", "measured 18.4, 29.4, 39", row.expected_spin,
        half_digit(1), job, final_spin);
    cases.push_back({group, "tangential force turns, ms", "measured 3.2, 3.1, 3.5",
                     row.expected_reversal_ms, 0.01, [job] { return reversal_ms(job); }});
  }
}

void add_wood_damping(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on wood, damping";
  ImpactJob job = job::wood_published_job();
  add(cases, group, "b = 9.5 in compression: restitution", "printed 0.82", 0.90, 0.005, job,
      restitution);
  job.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  add(cases, group, "b = 9.5 in both phases: restitution", "printed 0.82", 0.81, 0.005, job,
      restitution);
  job.contact.restitution_damping = RestitutionDamping::kNone;
  job.contact.damping_n_s_per_m = 18;
  add(cases, group, "b = 18 in compression: restitution", "printed 0.82", 0.82, 0.01, job,
      restitution);
}

}  // namespace

std::vector<VerifyCase> source_cases() {
  std::vector<VerifyCase> cases;
  add_racket(cases);
  add_racket_oblique(cases);
  add_wood_regression(cases);
  add_wood_steeper(cases);
  add_wood_sound(cases);
  add_wood_damping(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
