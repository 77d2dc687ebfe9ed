// Rows of `impactdic verify` for chapters 3 and 4: what the dissertation prints, and beside it our
// own figures as regression values.
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

double final_vt(const ImpactResult& r) { return r.final.vt_m_s; }
double final_vn(const ImpactResult& r) { return r.final.vn_m_s; }
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

const char* const kRegression = "regression";

// What is printed, within so much of it, and our own figure, so that it does not change unnoticed.
struct PrintedRow {
  const char* name;
  const char* section;
  double printed, within, ours;
  Figure figure;
};

void add_printed(std::vector<VerifyCase>& cases, const std::string& group, const ImpactJob& job,
                 const PrintedRow& row) {
  add(cases, group, row.name, "printed, " + std::string(row.section), row.printed, row.within, job,
      row.figure);
  add(cases, group, std::string(row.name) + " (ours)", kRegression, row.ours,
      1e-5 * std::abs(row.ours), job, row.figure);
}

void add_racket(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on a racket, 15 deg, 2 m/s";
  const ImpactJob job = job::racket_job();
  add_printed(cases, group, job,
              {"time of maximum compression, ms", "section 3.1.3", 3.1, half_digit(1), 3.06768,
               compression_ms});
  add_printed(
      cases, group, job,
      {"normal velocity after, m/s", "section 3.1.3", 1.67, half_digit(2), 1.669427, final_vn});
  add_printed(cases, group, job,
              {"restitution", "section 3.1.3", 0.86, half_digit(2), 0.864159, restitution});
  // Section 3.1.3 has these in figures without figures in print.
  add(cases, group, "force at maximum compression, N", kRegression, 46.53, half_digit(2), job,
      [](const ImpactResult& r) { return r.max_force_n; });
  add(cases, group, "maximum deflection, mm", kRegression, 3.476, half_digit(3), job,
      [](const ImpactResult& r) { return 1e3 * r.max_deflection_m; });
  add(cases, group, "contact duration, ms", kRegression, 6.325, half_digit(3), job, contact_ms);
  cases.push_back(
      {group, "force at the first touch, N", "formula: b v_n", 10.355, half_digit(3), [job] {
         const double touch_s = 0;
         const contact::Recording at_touch{.times_s = std::span(&touch_s, 1)};
         return contact::simulate_impact(job, at_touch).trajectory[0].normal_force_n;
       }});
  ImpactJob damped = job;
  damped.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  add(cases, group, "damped to zero deflection: final force is negative",
      "printed, section 3.1.3 (no figure)", -1, 0, damped,
      [](const ImpactResult& r) { return r.separation_force_n < 0 ? -1.0 : 1.0; });
  add(cases, group, "damped to zero deflection: final force, N", kRegression, -7.58, half_digit(2),
      damped, [](const ImpactResult& r) { return r.separation_force_n; });
  add(cases, group, "damped to zero deflection: restitution", kRegression, 0.7322, half_digit(4),
      damped, restitution);
}

void add_racket_oblique(std::vector<VerifyCase>& cases) {
  // Before, measured after (for the friction of Eq. 3.12), printed theory, and our figures. A
  // linear law with one (k, b) has one restitution; the printed velocities imply four, so that they
  // are met within 6 % only.
  struct Row {
    double angle_deg, vt, vn, measured_vt, measured_vn, printed_vt, printed_vn, ours_vt, ours_vn;
  };
  for (const Row& row : {Row{15, -0.57, -2.50, -0.41, 2.27, -0.44, 2.14, -0.427669, 2.161379},
                         Row{30, -1.81, -3.52, -1.10, 3.13, -1.20, 2.96, -1.134278, 3.044921},
                         Row{45, -2.68, -2.96, -1.68, 2.63, -1.66, 2.44, -1.728310, 2.560574},
                         Row{57, -2.61, -1.73, -1.55, 1.59, -1.54, 1.47, -1.621118, 1.496101}}) {
    ImpactJob job = job::racket_job();
    job.surface_angle_deg = row.angle_deg;
    job.initial.vt_m_s = row.vt;
    job.initial.vn_m_s = row.vn;
    job.contact.friction_kinetic = (row.measured_vt - row.vt) / (row.measured_vn - row.vn);
    const std::string group =
        "ball on a racket, oblique " + std::to_string(static_cast<int>(row.angle_deg)) + " deg";
    add_printed(cases, group, job,
                {"tangential velocity after, m/s", "section 3.3.2", row.printed_vt,
                 0.06 * std::abs(row.printed_vt), row.ours_vt, final_vt});
    add_printed(cases, group, job,
                {"normal velocity after, m/s", "section 3.3.2", row.printed_vn,
                 0.06 * row.printed_vn, row.ours_vn, final_vn});
  }
}

// How far the normal velocity after lies below the measured 2.27 m/s, %, 15 degrees. The tangential
// errors (6.7 and 10.1 % printed, 4.3 and 6.8 % ours) are of the second printed digit of 0.41 m/s.
void add_racket_errors(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on a racket, oblique 15 deg";
  ImpactJob job = job::racket_job();
  job.initial.vt_m_s = -0.57;
  job.initial.vn_m_s = -2.50;
  const Figure error = [](const ImpactResult& r) { return 100 * (2.27 - r.final.vn_m_s) / 2.27; };
  add_printed(cases, group, job,
              {"error of the normal velocity, %", "section 3.3.2", 5.4, 1, 4.785078, error});
  job.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  add_printed(cases, group, job,
              {"the same, damped in restitution, %", "section 3.4", 19.8, 1, 19.27979, error});
}

// The printed figures do not follow from the printed friction; the preset's reading meets them to 4
// % in time and spin and to 0.02 m/s.
void add_wood_regression(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on wood, published rule, 20 deg";
  constexpr double kPart = 0.04, kSpeed = 0.02;
  ImpactJob job = job::wood_published_job();
  const auto printed = [&](const char* name, double value, double within, double ours,
                           Figure figure) {
    add_printed(cases, group, job, {name, "section 4.4", value, within, ours, figure});
  };
  printed("sliding ends, ms", 2.08, kPart * 2.08, 2.161047, sliding_end_ms);
  printed("sticking ends, ms", 3.31, kPart * 3.31, 3.386298, sticking_end_ms);
  printed("tangential velocity, m/s", 0.26, kSpeed, 0.277590, final_vt);
  printed("spin, rad/s", 22.1, kPart * 22.1, 21.615015, final_spin);
  add(cases, group, "maximum compression, ms", kRegression, 2.771607, 2.8e-6, job, compression_ms);
  add(cases, group, "contact duration, ms", kRegression, 5.656875, 5.7e-6, job, contact_ms);
  add(cases, group, "sticking feeds energy in: warnings", "conservation", 1, 0, job,
      [](const ImpactResult& r) { return static_cast<double>(r.warnings.size()); });
  job.friction = FrictionModel::kFullSliding;
  printed("full sliding: tangential velocity, m/s", 0.01, kSpeed, 0.02058187, final_vt);
  printed("full sliding: spin, rad/s", 41.2, kPart * 41.2, 41.93186, final_spin);
  job.friction = FrictionModel::kBrody;
  printed("Brody: tangential velocity, m/s", 0.40, half_digit(2), 0.4019637, final_vt);
  printed("Brody: spin, rad/s", 12.55, kPart * 12.55, 12.71032, final_spin);
}

// The initial velocities are not printed; those chosen meet the printed rebounds within 4 % of the
// tangential velocity before and 2 % of the spin.
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
    add(cases, group, model + ": tangential velocity, m/s", "printed, section 4.4", row.printed_vt,
        0.035 * std::abs(row.vt), job, final_vt);
    add(cases, group, model + ": spin, rad/s", "printed, section 4.4", row.printed_spin,
        0.02 * row.printed_spin, job, final_spin);
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
  // Measured: 0.31, 0.46, 0.59 m/s; 18.4, 29.4, 39 rad/s; 3.2, 3.1, 3.5 ms. A few thousand springs
  // differ from their limit by up to 6e-4 m/s.
  const char* const kSprings = "independent calculation, discrete springs";
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
    add(cases, group, "tangential velocity after, m/s", kSprings, row.expected_vt, 1e-3, job,
        final_vt);
    add(cases, group, "spin after, rad/s", kSprings, row.expected_spin, half_digit(1), job,
        final_spin);
    cases.push_back({group, "tangential force turns, ms", kSprings, row.expected_reversal_ms, 0.01,
                     [job] { return reversal_ms(job); }});
  }
}

void add_wood_damping(std::vector<VerifyCase>& cases) {
  const std::string group = "ball on wood, damping";
  ImpactJob job = job::wood_published_job();
  add(cases, group, "b = 9.5 in compression: restitution (0.82 printed)", kRegression, 0.90, 0.005,
      job, restitution);
  job.contact.restitution_damping = RestitutionDamping::kToZeroDeflection;
  add(cases, group, "b = 9.5 in both phases: restitution (0.82 printed)", kRegression, 0.81, 0.005,
      job, restitution);
  job.contact.restitution_damping = RestitutionDamping::kNone;
  job.contact.damping_n_s_per_m = 18;
  add(cases, group, "b = 18 in compression: restitution", "printed, section 4.3", 0.82, 0.01, job,
      restitution);
}

}  // namespace

std::vector<VerifyCase> source_cases() {
  std::vector<VerifyCase> cases;
  add_racket(cases);
  add_racket_oblique(cases);
  add_racket_errors(cases);
  add_wood_regression(cases);
  add_wood_steeper(cases);
  add_wood_sound(cases);
  add_wood_damping(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
