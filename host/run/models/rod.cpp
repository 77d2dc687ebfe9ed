#include <impactdic/error.h>
#include <impactdic/rod.h>
#include <impactdic/units.h>

#include <cmath>

#include "host/base/parallel/parallel_for.h"
#include "sim/contact/law/normal_elastoplastic.h"
#include "sim/rod/rod_impact.h"
#include "sim/rod/rod_motion.h"

namespace impactdic {
namespace {

constexpr std::size_t kFewestRodFrames = 12;

void require(bool good, const char* what, const char* key, const char* hint = "") {
  if (!good) throw InvalidArgument(what, key, hint);
}

// A preset with the bodies of the request.
RodJob with_bodies(RodJob preset, const RodRequest& request) {
  preset.body = request.measure.body;
  preset.friction_kinetic = request.measure.friction_kinetic;
  preset.gravity_m_s2 = request.measure.gravity_m_s2;
  preset.modal_damping = request.modal_damping;
  preset.surface.radius_m = request.measure.body.radius_m;
  preset.surface.poisson = request.poisson;
  preset.surface.yield_strength_pa = request.yield_strength_pa;
  preset.surface.effective_modulus_pa = sim::contact::effective_modulus_pa(
      request.measure.body.young_pa, request.poisson, request.flat_young_pa, request.poisson);
  return preset;
}

RodPrediction predict(const char* model, RodJob job, const RodSide& before) {
  job.angle_rad = before.angle_rad.value;
  job.vt_m_s = before.vt_m_s.value;
  job.vn_m_s = before.vn_m_s.value;
  job.omega_rad_s = before.omega_rad_s.value;
  return {model, sim::rod::simulate_rod(job)};
}

double dent_m(RodJob job, const DeformationRow& row) {
  job.angle_rad = row.angle_deg * kRadPerDeg;
  job.vn_m_s = -row.speed_m_s;
  return sim::rod::simulate_rod(job).residual_m;
}

void validate_markers(const MarkerTable& table) {
  const std::size_t frames = table.time_s.size();
  require(frames >= kFewestRodFrames, "fewer than 12 frames", "markers",
          "velocities before and after an impact need at least 12");
  for (const auto& marker : table.markers) {
    require(marker.size() == frames, "the markers' lists differ in length", "markers");
  }
  require(table.interval_s > 0, "interval_s must be positive", "markers");
  for (std::size_t i = 1; i < frames; ++i) {
    require(table.time_s[i] > table.time_s[i - 1], "time_s does not ascend", "markers");
  }
}

}  // namespace

RodJob RodRequest::rigid_model() const { return with_bodies(rigid_rod_preset(), *this); }

RodJob RodRequest::flexible_model() const { return with_bodies(flexible_rod_preset(), *this); }

void RodRequest::validate() const {
  for (RodJob probe : {rigid_model(), flexible_model()}) {
    probe.angle_rad = 1, probe.vn_m_s = -1;  // the markers tell speed and angle
    probe.validate();
  }
  require(measure.vertical_axis < 3, "there is no such axis", "vertical_axis", "0 x, 1 y, 2 z");
  require(std::isfinite(measure.gravity_m_s2), "must be a number", "gravity_m_s2");
  require(std::isfinite(measure.centre_offset_m), "must be a number", "centre_offset_m");
  require(threads >= 0, "must not be negative", "threads");
  for (const DeformationRow& row : deformations) {
    require(row.angle_deg > 0 && row.angle_deg < 180, "must lie in 0..180",
            "deformations.angle_deg");
    require(row.speed_m_s > 0, "must be positive", "deformations.speed_m_s");
  }
  validate_markers(markers);
}

RodResult measure_rod(const RodRequest& request, const RunControl& control) {
  request.validate();
  RodResult result;
  result.measurement = sim::rod::measure_rod(request.markers, request.measure);
  const RodJob rigid = request.rigid_model(), flexible = request.flexible_model();
  result.predictions.push_back(predict("rigid_rod", rigid, result.measurement.before));
  result.predictions.push_back(predict("flexible_rod", flexible, result.measurement.before));
  result.deformations.resize(request.deformations.size());
  const std::vector<char> done = parallel_pieces(
      result.deformations.size(), request.threads, "deformations", control, [&](std::size_t i) {
        const DeformationRow& row = request.deformations[i];
        result.deformations[i] = {row, dent_m(rigid, row), dent_m(flexible, row)};
      });
  result.cancelled = keep_done(done, result.deformations);
  return result;
}

}  // namespace impactdic
