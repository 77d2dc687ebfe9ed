#include "host/dic/device/sphere_search.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/dic/sphere/rotation.h"
#include "host/opencl/arguments.h"

namespace impactdic::dic {
namespace {

// Turns over all of SO(3), about 5° from each other, and the side of the maps that they are scored
// on: a cell in the middle is 5° of the surface.
constexpr int kTurns = 72000, kCoarseSide = 24;
// The best of them are moved about in steps that halve, on maps whose cells are as fine as these.
constexpr std::size_t kKept = 96;
struct Refinement {
  double step_deg;
  int side;
};
constexpr Refinement kRefinements[] = {{3.2, 36}, {1.6, 48}, {0.8, 64}};
// Turns that differ by less are one.
constexpr double kAlike_deg = 3;
// Grey levels of 255; what deviates less is noise.
constexpr double kLeastContrast = 3;
constexpr std::size_t kGroup = 64;

bool by_score(const SphereTurn& a, const SphereTurn& b) { return a.score > b.score; }

Eigen::Quaterniond quaternion(const SphereTurn& turn) { return {turn.w, turn.x, turn.y, turn.z}; }

double between_deg(const SphereTurn& a, const SphereTurn& b) {
  return quaternion(a).angularDistance(quaternion(b)) * kDegPerRad;
}

// The best `most`, without those that are like a better one.
std::vector<SphereTurn> best_of(std::vector<SphereTurn> turns, std::size_t most, double alike_deg) {
  std::sort(turns.begin(), turns.end(), by_score);
  std::vector<SphereTurn> best;
  for (const SphereTurn& turn : turns) {
    if (best.size() == most) break;
    const bool known = std::any_of(best.begin(), best.end(), [&](const SphereTurn& other) {
      return between_deg(turn, other) < alike_deg;
    });
    if (!known) best.push_back(turn);
  }
  return best;
}

// Every turn and those a step away from it about any axis.
std::vector<SphereTurn> about(const std::vector<SphereTurn>& turns, double step_rad) {
  std::vector<SphereTurn> all;
  for (const SphereTurn& turn : turns) {
    for (int k = 0; k < 27; ++k) {
      const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
      const Eigen::Vector3d step(x, y, z);
      const Eigen::Quaterniond q = quaternion(turn) * quaternion_of(step_rad * step);
      all.push_back({q.w(), q.x(), q.y(), q.z(), 0});
    }
  }
  return all;
}

}  // namespace

std::vector<SphereTurn> even_turns(int count) {
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;  // psi⁴ = psi + 4
  std::vector<SphereTurn> turns;
  for (int i = 0; i < count; ++i) {
    const double s = i + 0.5, t = s / count;
    const double alpha = 2 * kPi * s / phi, beta = 2 * kPi * s / psi;
    const double r = std::sqrt(t), rest = std::sqrt(1 - t);
    turns.push_back({r * std::sin(alpha), r * std::cos(alpha), rest * std::sin(beta),
                     rest * std::cos(beta), 0});
  }
  return turns;
}

void SphereSearch::prepare() {
  if (shrink_() != nullptr) return;
  shrink_ = engine_.kernel("ball/sphere_search.cl", "shrink_ball", {});
  score_ = engine_.kernel("ball/sphere_search.cl", "score_turns", {});
  everywhere_ = even_turns(kTurns);
}

void SphereSearch::shrink(DeviceFrames& frames, const SphereSearchTask& task, int side) {
  const auto cells = static_cast<std::size_t>(side);
  maps_.reserve(engine_, 2 * cells * cells);
  opencl::set_arguments(shrink_, frames.images().get(), frames.width(), frames.height(), task,
                        static_cast<float>(kLeastContrast * frames.full_scale() / 255),
                        maps_.get());
  const double pixels = 25.0 * 8 * task.radius * task.radius;
  engine_.launch(engine_.queue(), shrink_, cl::NDRange(cells, cells, 2), cl::NullRange,
                 {4 * pixels, 8 * pixels});
}

void SphereSearch::score(std::vector<SphereTurn>& turns, int side) {
  std::vector<cl_float4> quaternions;
  quaternions.reserve(turns.size());
  for (const SphereTurn& t : turns) {
    quaternions.push_back({{static_cast<float>(t.w), static_cast<float>(t.x),
                            static_cast<float>(t.y), static_cast<float>(t.z)}});
  }
  turns_.reserve(engine_, turns.size());
  scores_.reserve(engine_, turns.size());
  turns_.write(engine_, quaternions);
  opencl::set_arguments(score_, maps_.get(), side, static_cast<cl_int>(turns.size()), turns_.get(),
                        scores_.get());
  const double cells = static_cast<double>(turns.size()) * side * side;
  const std::size_t groups = (turns.size() + kGroup - 1) / kGroup;
  engine_.launch(engine_.queue(), score_, cl::NDRange(groups * kGroup), cl::NDRange(kGroup),
                 {8 * cells, 40 * cells});
  std::vector<float> scores(turns.size());
  scores_.read(engine_, scores);
  for (std::size_t i = 0; i < turns.size(); ++i) turns[i].score = static_cast<double>(scores[i]);
}

std::vector<SphereTurn> SphereSearch::find(DeviceFrames& frames, const SphereSearchTask& task,
                                           std::size_t most) {
  for (const int slot : {task.first, task.second}) {
    if (frames.version(slot) == 0) throw InvalidArgument("a frame slot is empty");
  }
  if (!(task.radius > 0)) throw InvalidArgument("a ball's radius must be positive");
  prepare();
  shrink(frames, task, kCoarseSide);
  std::vector<SphereTurn> turns = everywhere_;
  score(turns, kCoarseSide);
  turns = best_of(std::move(turns), kKept, kAlike_deg);
  for (const Refinement& refinement : kRefinements) {
    turns = about(turns, refinement.step_deg * kRadPerDeg);
    shrink(frames, task, refinement.side);
    score(turns, refinement.side);
    turns = best_of(std::move(turns), kKept, refinement.step_deg);
  }
  return best_of(std::move(turns), most, kAlike_deg);
}

}  // namespace impactdic::dic
