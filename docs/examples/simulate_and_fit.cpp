// A tennis ball hits a level surface: simulates the impact by a model, then finds the surface's
// stiffness and damping again from a track: a measured one whose file is given, or the simulated
// one as a camera of 10 000 frames/s might have measured it.
//
//     simulate_and_fit [track.csv]
#include <impactdic/impactdic.h>

#include <cstdio>
#include <random>

namespace idic = impactdic;

// The simulated path with noise: centres by 10 um, motions by 5 um and 0.2 mrad.
idic::MeasuredTrack filmed(const std::vector<idic::TrajectoryPoint>& path, double interval_s) {
  std::mt19937 random(1);
  const auto noise = [&](double sd) { return std::normal_distribution<double>(0, sd)(random); };
  idic::MeasuredTrack track;
  track.interval_s = interval_s;
  track.metre_per_px = 2.5e-4;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const auto &here = path[k].state, &next = path[k + 1].state;
    track.time_s.push_back(interval_s * k);
    track.x_m.push_back(here.qt_m + noise(1e-5));
    track.y_m.push_back(here.qn_m + noise(1e-5));
    track.position_sd_m.push_back(1e-5);
    track.dx_m.push_back(next.qt_m - here.qt_m + noise(5e-6));
    track.dy_m.push_back(next.qn_m - here.qn_m + noise(5e-6));
    track.motion_sd_m.push_back(5e-6);
    track.turn_rad.push_back(next.angle_rad - here.angle_rad + noise(2e-4));
    track.turn_sd_rad.push_back(2e-4);
  }
  return track;
}

int main(int count, char** arguments) try {
  idic::SimulateRequest request;
  request.impact.body = {idic::BodyShape::kHollowSphere, 0.0567, 0.067};  // kg, m
  request.impact.contact.stiffness = 13385;                               // N/m
  request.impact.contact.damping_n_s_per_m = 5.36;
  request.impact.contact.friction_kinetic = 0.1;
  request.impact.initial = {-1.2, -3.0, 0};  // along the surface and out of it, m/s; no spin
  for (int frame = -40; frame < 110; ++frame) request.times_s.push_back(1e-4 * frame);
  const idic::ImpactResult impact = idic::simulate(request);
  std::printf("simulated: restitution %.9g contact_s %.9g\n", impact.restitution, impact.contact_s);

  idic::FitRequest fit;
  fit.impact = request.impact;  // body and laws, and what of the contact is not fitted
  fit.parameters = {idic::FitParameter::kStiffness, idic::FitParameter::kDamping};
  fit.shots.resize(1);
  if (count > 1) fit.shots[0].track = arguments[1];
  if (count <= 1) fit.shots[0].in_memory = filmed(impact.trajectory, 1e-4);
  const idic::FitResult found = idic::fit(fit);
  for (const idic::ParameterEstimate& one : found.shots[0].parameters) {
    std::printf("fitted: %s %.9g sd %.9g\n", one.key.c_str(), one.value, one.sd);
  }
} catch (const idic::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());  // WHAT (WHERE): HINT
  return 1;
}
