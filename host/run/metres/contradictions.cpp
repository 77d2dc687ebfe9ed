#include "host/run/metres/contradictions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host/run/metres/impact_figures.h"
#include "host/run/metres/surface_edge.h"

namespace impactdic::run {
namespace {

// Deviations beyond which two values do not agree. The chance of one in 370 for each check is too
// much for two hundred shots: one in 15 000.
constexpr double kChance = 4;
// What may differ without a slip: drag of the air and a rounded direction of gravity; the lever arm
// of a flattened ball; a height taken with a ruler; a ball that comes nearer to the camera.
constexpr double kFallTolerance = 0.05, kLeverTolerance = 0.02, kSpeedTolerance = 0.05,
                 kDriftTolerance = 0.005;
// Slip out of the picture's plane that matters: of the slip in it, and of the normal velocity, for
// a friction that is left out by it comes to 0.01 at most.
constexpr double kSideOfSlip = 0.2, kSideOfSpeed = 0.05;
constexpr double kLeastAngle_deg = 0.05;
constexpr double kHollow = 2.0 / 3, kSolid = 2.0 / 5, kDisc = 1.0 / 2;
constexpr double kSmallestBall_mm = 3, kLargestBall_mm = 1500;

template <typename... Values>
std::string say(const char* format, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

using Figures = std::vector<ImpactFigure>;

const Figures kVelocities = {ImpactFigure::kVxBefore, ImpactFigure::kVyBefore,
                             ImpactFigure::kVtBefore, ImpactFigure::kVnBefore,
                             ImpactFigure::kVxAfter,  ImpactFigure::kVyAfter,
                             ImpactFigure::kVtAfter,  ImpactFigure::kVnAfter};
// All that goes by the surface's axes.
const Figures kLocal = {ImpactFigure::kVtBefore,          ImpactFigure::kVnBefore,
                        ImpactFigure::kVtAfter,           ImpactFigure::kVnAfter,
                        ImpactFigure::kRestitution,       ImpactFigure::kFriction,
                        ImpactFigure::kFrictionPublished, ImpactFigure::kRollingCap,
                        ImpactFigure::kClosingInertia,    ImpactFigure::kMaxDeflection};

Figures all_figures() {
  Figures all;
  for (std::size_t i = 0; i < kImpactFigures; ++i) all.push_back(static_cast<ImpactFigure>(i));
  return all;
}

std::string likely_angle(double given, const Measured& found_deg) {
  const double near = kChance * found_deg.sd + 1;
  const auto is = [&](double angle) {
    return std::abs(turned_into(found_deg.value - angle)) < near;
  };
  if (given == 0) return "was --surface-angle-deg forgotten?";
  if (is(-given)) return "has --surface-angle-deg the wrong sign?";
  if (is(90 - given) || is(given - 90)) return "was --surface-angle-deg taken from the vertical?";
  if (is(180 - given) || is(180 + given)) return "was --surface-angle-deg taken the other way?";
  return "is --surface-angle-deg right?";
}

class Search {
 public:
  Search(const TrackRequest& request, const ImpactAnalysis& analysis, ImpactFigures& figures)
      : request_(request), analysis_(analysis), figures_(figures) {}

  void run() {
    set_directions();
    size_of_ball();
    if (!figures_.found()) return;
    const bool falls = gravity();
    surface();
    restitution();
    drop_height(falls);
    side_slip();
    radius();
  }

 private:
  void add(const char* what, std::string message, Figures figures) {
    figures_.contradictions.push_back({what, std::move(message), std::move(figures)});
  }

  bool is_known(const char* what) const { return contradicts(figures_, what); }

  void set_directions();
  void size_of_ball();
  bool gravity();
  bool direction_of_gravity();
  void surface();
  void restitution();
  void drop_height(bool falls);
  void side_slip();
  void radius();
  std::string likely_slip(double fall_over_g) const;

  const TrackRequest& request_;
  const ImpactAnalysis& analysis_;
  ImpactFigures& figures_;
};

void Search::set_directions() {
  const Measured& off = analysis_.surface_off_rad;
  if (std::isfinite(off.value)) {
    figures_.surface_angle_deg = {turned_into(request_.surface_angle_deg + off.value * kDegPerRad),
                                  off.sd * kDegPerRad};
  }
  const Measured &along = analysis_.fall, &across = analysis_.fall_across;
  const double fall_sq = along.value * along.value + across.value * across.value;
  if (fall_sq > 0) {
    const double off_rad = std::atan2(across.value, along.value);
    const double sd =
        std::hypot(along.value * across.sd, across.value * along.sd) / fall_sq * kDegPerRad;
    figures_.gravity_angle_deg = {turned_into(request_.gravity_angle_deg + off_rad * kDegPerRad),
                                  sd};
  }
}

// Where too little flight is seen for gravity to tell, a unit may still be plain.
void Search::size_of_ball() {
  const double mm = request_.ball_diameter_mm;
  if (mm == 0 || (mm >= kSmallestBall_mm && mm <= kLargestBall_mm)) return;
  add("scale", say("a ball of %g mm across: is --ball-diameter-mm in another unit?", mm),
      all_figures());
}

// With scale s and rate f that are not the true ones, gravity comes out as 9.81 s f^2 over theirs.
std::string Search::likely_slip(double fall_over_g) const {
  struct Slip {
    double factor;
    const char* question;
  };
  const bool by_diameter = request_.ball_diameter_mm > 0;
  const std::array slips = {
      Slip{1e-3, by_diameter ? "is the diameter in m?" : "is the scale in m a pixel?"},
      Slip{1e-1, by_diameter ? "is the diameter in cm?" : "is the scale in cm a pixel?"},
      Slip{1 / 25.4, by_diameter ? "is the diameter in inches?" : "is the scale in inches?"},
      Slip{1e3, "is the scale in um?"},
      Slip{0.5, by_diameter ? "is it the radius instead of the diameter?"
                            : "is the scale half of what it should be?"},
      Slip{2, "is the scale twice what it should be?"},
      Slip{1e-2, "is the frame rate a tenth of the true one?"},
      Slip{1e2, "is the frame rate ten times the true one?"},
      Slip{0.25, "is the frame rate half of the true one?"},
      Slip{4, "is the frame rate twice the true one?"},
      Slip{1e-4, "is the frame rate a hundredth of the true one?"},
      Slip{1e4, "is the frame rate a hundred times the true one?"}};
  const Slip* best = nullptr;
  double nearest = std::log(1.3);
  for (const Slip& slip : slips) {
    const double off = std::abs(std::log(fall_over_g / slip.factor));
    if (off < nearest) nearest = off, best = &slip;
  }
  return best != nullptr ? best->question : "are scale and frame rate right?";
}

// Whether the flights show a fall that tells something.
bool Search::gravity() {
  const Measured& fall = figures_.gravity_m_s2;
  if (!std::isfinite(fall.value)) return false;
  const double allowed = kChance * fall.sd + kFallTolerance * kGravity_m_s2;
  const bool direction = direction_of_gravity();
  if (std::abs(fall.value - kGravity_m_s2) <= allowed || direction) return true;
  const double ratio = fall.value / kGravity_m_s2;
  const std::string question =
      ratio > 0 ? likely_slip(ratio) : "does gravity point the other way (--gravity-angle-deg)?";
  add("gravity",
      say("gravity comes out %.3g +- %.2g m/s^2: %s", fall.value, fall.sd, question.c_str()),
      all_figures());
  return true;
}

// As strong as it must be, but another way.
bool Search::direction_of_gravity() {
  const Measured &along = analysis_.fall, &across = analysis_.fall_across;
  if (!std::isfinite(across.value)) return false;
  const double unit = figures_.gravity_m_s2.value / along.value;
  const double off = std::abs(across.value * unit), sd = across.sd * std::abs(unit);
  if (!(off > kChance * sd + kFallTolerance * kGravity_m_s2)) return false;
  const double strength = std::hypot(along.value, across.value) * std::abs(unit);
  if (std::abs(strength - kGravity_m_s2) > 2 * kChance * sd + 0.3 * kGravity_m_s2) return false;
  const double found = figures_.gravity_angle_deg.value;
  const double turn = turned_into(found - request_.gravity_angle_deg);
  std::string question = "was the camera tilted?";
  if (std::abs(turn) > 60) question = "are the picture's axes swapped?";
  add("gravity_angle",
      say("the flights fall towards %.1f +- %.1f degrees, not %g (--gravity-angle-deg): %s", found,
          figures_.gravity_angle_deg.sd, request_.gravity_angle_deg, question.c_str()),
      all_figures());
  return true;
}

// The impulse along the surface must be the one that changes the spin. An angle or an inertia
// factor may be wrong; one that is of no usual ball is left aside.
void Search::surface() {
  const Measured& off = analysis_.surface_off_rad;
  if (!std::isfinite(off.value) || is_known("gravity_angle")) return;
  const double lean = std::abs(std::atan(analysis_.friction.value));
  const double sd = std::hypot(off.sd, request_.surface_angle_sd_deg * kRadPerDeg);
  const double allowed = kChance * sd + kLeverTolerance * lean + kLeastAngle_deg * kRadPerDeg;
  if (std::abs(off.value) <= allowed) return;
  const Measured& closing = figures_.closure.inertia_factor;
  for (const double usual : {kHollow, kSolid, kDisc}) {
    const bool suits =
        std::abs(closing.value - usual) <= kChance * closing.sd + kLeverTolerance * usual;
    const bool given = std::abs(request_.inertia_factor - usual) < kLeverTolerance * usual;
    if (!suits || given || request_.inertia_factor == 0) continue;
    add("inertia_factor",
        say("the change of spin asks for an inertia factor of %.3f +- %.3f, %g is given: is the "
            "ball %s?",
            closing.value, closing.sd, request_.inertia_factor,
            usual == kHollow  ? "hollow (0.667)"
            : usual == kSolid ? "solid (0.4)"
                              : "a disc (0.5)"),
        {ImpactFigure::kRollingCap});
    return;
  }
  const Measured& found = figures_.surface_angle_deg;
  add("surface_angle",
      say("path and spin show the surface at %.2f +- %.2f degrees, %g is given: %s", found.value,
          found.sd, request_.surface_angle_deg,
          likely_angle(request_.surface_angle_deg, found).c_str()),
      kLocal);
}

// Also without any spin: no surface gives back more than it got, and none pushes a ball along.
void Search::restitution() {
  const Measured &e = figures_.restitution, &friction = figures_.friction;
  const bool known = std::any_of(figures_.contradictions.begin(), figures_.contradictions.end(),
                                 [](const Contradiction& c) { return c.what == "surface_angle"; });
  if (known) return;
  if (e.value > 1 + kChance * e.sd) {
    add("restitution",
        say("a restitution of %.3f, more than 1: is --surface-angle-deg right?", e.value), kLocal);
  } else if (friction.value < -kChance * friction.sd - kLeverTolerance) {
    add("friction",
        say("a friction of %.3f, which pushes the ball along: has --surface-angle-deg the wrong "
            "sign?",
            friction.value),
        kLocal);
  }
}

void Search::drop_height(bool falls) {
  if (request_.drop_height_mm == 0 || !figures_.in_si) return;
  const ImpactMotion& before = figures_.before;
  const double speed = std::hypot(before.vx.value, before.vy.value);
  const double sd = std::hypot(before.vx.value * before.vx.sd, before.vy.value * before.vy.sd) /
                    std::max(speed, 1e-12);
  const double expected = std::sqrt(2 * kGravity_m_s2 * request_.drop_height_mm * 1e-3);
  if (std::abs(speed - expected) <= kChance * sd + kSpeedTolerance * expected) return;
  const bool fall_is_right = falls && !is_known("gravity");
  add("drop_height",
      say("the ball comes with %.3f +- %.3f m/s, a fall of %g mm gives %.3f: %s", speed, sd,
          request_.drop_height_mm, expected,
          fall_is_right ? "is --drop-height-mm right, to the touch and in mm?"
                        : "are scale and frame rate right?"),
      kVelocities);
}

// The picture's plane shows only a part of the friction where the contact point slips out of it.
void Search::side_slip() {
  if (!analysis_.space) return;
  const Measured& side = analysis_.space->slip_b;
  const double along = std::abs(analysis_.space->slip_t.value);
  const double beyond = std::abs(side.value) - kChance * side.sd;
  if (!(beyond > kSideOfSlip * along) ||
      !(beyond > kSideOfSpeed * std::abs(analysis_.before.vn.value))) {
    return;
  }
  add("side_slip",
      say("the contact point slips out of the picture's plane, too: 'friction' is the part in it%s",
          request_.inertia_factor > 0 ? ", 'space' has the whole"
                                      : "; --inertia-factor tells the whole"),
      {ImpactFigure::kFriction, ImpactFigure::kFrictionPublished, ImpactFigure::kRollingCap});
}

void Search::radius() {
  const double drift = analysis_.radius_drift_px, r = analysis_.radius_px.value;
  if (!(std::abs(drift) > kDriftTolerance * r)) return;
  Figures concerned = kVelocities;
  concerned.push_back(ImpactFigure::kMaxDeflection);
  add("radius",
      say("the ball is %.2f %% %s after the contact than before: does it move %s the camera, or is "
          "the light uneven?",
          std::abs(100 * drift / r), drift > 0 ? "larger" : "smaller",
          drift > 0 ? "towards" : "away from"),
      concerned);
}

}  // namespace

std::vector<ImpactFigure> figures_of_surface() { return kLocal; }

bool contradicts(const ImpactFigures& figures, const std::string& what) {
  return std::any_of(figures.contradictions.begin(), figures.contradictions.end(),
                     [&](const Contradiction& c) { return c.what == what; });
}

void note_other_surface(const TrackRequest& request, const ImpactAnalysis& other, double angle_deg,
                        ImpactFigures& figures) {
  const Measured& off = other.surface_off_rad;
  const bool known = std::isfinite(off.value);
  figures.surface_angle_deg = {turned_into(angle_deg + (known ? off.value * kDegPerRad : 0.0)),
                               known ? off.sd * kDegPerRad : 45};
  figures.contradictions.push_back(
      {"surface_angle",
       say("no impact on a surface at %g degrees, but one at about %.0f: %s",
           request.surface_angle_deg, figures.surface_angle_deg.value,
           likely_angle(request.surface_angle_deg, figures.surface_angle_deg).c_str()),
       all_figures()});
}

void find_contradictions(const TrackRequest& request, const ImpactAnalysis& analysis,
                         ImpactFigures& figures) {
  Search(request, analysis, figures).run();
}

}  // namespace impactdic::run
