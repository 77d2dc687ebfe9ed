// What laws of contact take from materials, and jobs that name them.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>

#include "sim/contact/impact.h"
#include "sim/job/job_toml.h"
#include "sim/job/source_jobs.h"
#include "tests/support/job_text.h"

namespace impactdic {
namespace {

using testing::error_of;
using testing::write_job;

// Alumina on glass (Kharaz, Gorham and Salman 2001).
const std::string kAlumina = R"(normal = "hertz_damper"
friction = "maw_barber_fawcett"
[body]
diameter_m = 0.005
density_kg_m3 = 4000.0
young_pa = 380e9
poisson = 0.23
[surface]
young_pa = 70e9
poisson = 0.25
[contact]
restitution = 0.98
restitution_speed_m_s = 3.9
friction_kinetic = 0.092
[initial]
vt_m_s = 1.0
vn_m_s = -3.9
[environment]
gravity_m_s2 = 0.0
)";

std::string replaced(const std::string& from, const std::string& to) {
  return testing::replaced(kAlumina, from, to);
}

TEST(Materials, GiveWhatHertzAndMindlinTake) {
  const ImpactJob job = sim::job::read_simulate_job(write_job(kAlumina)).impact;
  const double modulus = 1 / ((1 - 0.23 * 0.23) / 380e9 + (1 - 0.25 * 0.25) / 70e9);
  EXPECT_NEAR(job.contact.reduced_modulus_pa, modulus, 1e-3);
  EXPECT_NEAR(job.contact.stiffness, 4.0 / 3 * modulus * std::sqrt(0.0025), 1e-3);
  EXPECT_NEAR(job.body.mass_kg, 4000 * 4.18879020478639 * std::pow(0.0025, 3), 1e-16);
  // Mindlin 1949: k_t/k_n = 4 G*/(2 E*) a/a, with 1/G* of the two.
  const double g1 = 380e9 / 2.46, g2 = 70e9 / 2.5;
  const double shear = 1 / (1.77 / (4 * g1) + 1.75 / (4 * g2));
  const double nu = job.contact.poisson;
  EXPECT_NEAR(2 * (1 - nu) / (2 - nu), shear / modulus, 1e-14);
  EXPECT_GT(nu, 0.23);
  EXPECT_LT(nu, 0.26);
}

TEST(Materials, TheDampingGivesTheRestitutionAtItsSpeed) {
  for (const char* damping : {"none", "to_zero_force", "to_zero_deflection"}) {
    for (const double e : {0.3, 0.7, 0.98, 1.0}) {
      ImpactJob job = sim::job::read_simulate_job(
                          write_job(replaced("restitution = 0.98",
                                             "restitution = " + std::to_string(e) +
                                                 "\nrestitution_damping = \"" + damping + "\"")))
                          .impact;
      job.initial.vt_m_s = 0;
      EXPECT_NEAR(sim::contact::simulate_impact(job).restitution, e, 1e-9) << damping;
      // e depends on b/(m^0.6 k^0.4 v^0.2): less is lost at a higher speed.
      job.initial.vn_m_s *= 2;
      if (e < 1) {
        EXPECT_GT(sim::contact::simulate_impact(job).restitution, e) << damping;
      }
    }
  }
  ImpactJob linear = sim::job::racket_job();
  linear.take_materials({{}, {}, 0.8, 0});
  linear.gravity_m_s2 = 0;
  EXPECT_NEAR(sim::contact::simulate_impact(linear).restitution, 0.8, 1e-9);
}

TEST(Materials, OfAnElasticPlasticLaw) {
  std::string text = replaced("hertz_damper", "thornton");
  text.replace(text.find("maw_barber_fawcett"), 18, "coulomb");
  const std::size_t at = text.find("restitution = 0.98");
  text.replace(at, text.find("friction_kinetic") - at, "yield_strength_pa = 3e9\npoisson = 0.25\n");
  const SimulateRequest job = sim::job::read_simulate_job(write_job(text));
  EXPECT_NEAR(job.impact.contact.reduced_modulus_pa, 62.992e9, 0.1e9);
  const std::string resolved = sim::job::to_toml(job);
  EXPECT_EQ(sim::job::to_toml(sim::job::read_simulate_job(write_job(resolved))), resolved);
}

TEST(Materials, TheResolvedJobShowsBothAndReadsBack) {
  for (const bool two : {false, true}) {
    std::string text = kAlumina;
    if (two) {
      const std::size_t at = text.find("[surface]");
      text.replace(at, 9,
                   "[other]\ndiameter_m = 0.004\nmass_kg = 0.001\nvt_m_s = -0.3\nvn_m_s = 0.1");
    }
    const SimulateRequest job = sim::job::read_simulate_job(write_job(text));
    const std::string resolved = sim::job::to_toml(job);
    for (const char* key : {"young_pa", "stiffness_n_per_m1p5", "damping_n_s_per_m",
                            "reduced_modulus_pa", "restitution_speed_m_s"}) {
      EXPECT_NE(resolved.find(key), std::string::npos) << key;
    }
    const SimulateRequest again = sim::job::read_simulate_job(write_job(resolved));
    EXPECT_EQ(sim::job::to_toml(again), resolved);
    EXPECT_EQ(again.impact.contact.stiffness, job.impact.contact.stiffness);
    EXPECT_EQ(sim::contact::simulate_impact(again.impact).final.vt_m_s,
              sim::contact::simulate_impact(job.impact).final.vt_m_s);
  }
}

TEST(Materials, ContradictionsAndGapsAreErrors) {
  struct Row {
    const char *from, *to, *key, *says;
  };
  for (const Row& row :
       {Row{"[contact]", "[contact]\nstiffness_n_per_m1p5 = 1e9", "contact.stiffness_n_per_m1p5",
            "does not follow"},
        Row{"friction_kinetic", "poisson = 0.4\nfriction_kinetic", "contact.poisson",
            "does not follow"},
        Row{"restitution_speed_m_s = 3.9\n", "", "contact.restitution_speed_m_s", "missing"},
        Row{"restitution = 0.98", "restitution = 1.2", "contact.restitution", "at most 1"},
        Row{"young_pa = 70e9\npoisson = 0.25\n", "", "surface.young_pa", "missing"},
        Row{"poisson = 0.25", "poisson = 0.6", "surface.poisson", "0.5"},
        Row{"young_pa = 380e9", "young_pa = -1.0", "body.young_pa", "positive"},
        Row{"density_kg_m3 = 4000.0", "density_kg_m3 = 4000.0\nmass_kg = 0.1", "body.density_kg_m3",
            "without mass_kg"},
        Row{"[surface]", "[surface]\nradius_m = -0.002", "surface.radius_m", "wider"}}) {
    const std::string line = error_of(replaced(row.from, row.to));
    EXPECT_NE(line.find("/job.toml: " + std::string(row.key)), std::string::npos) << line;
    EXPECT_NE(line.find(row.says), std::string::npos) << line;
  }
}

// On a convex surface of its own radius the contact's radius is half the ball's.
TEST(Materials, ACurvedSurfaceIsSofter) {
  const ImpactJob flat = sim::job::read_simulate_job(write_job(kAlumina)).impact;
  const ImpactJob round =
      sim::job::read_simulate_job(write_job(replaced("[surface]", "[surface]\nradius_m = 0.0025")))
          .impact;
  EXPECT_NEAR(round.contact.stiffness / flat.contact.stiffness, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(round.contact_radius_m(), 0.00125, 1e-15);
}

}  // namespace
}  // namespace impactdic
