// The words of the impact's results.
#include <impactdic/impact.h>

#include <algorithm>
#include <array>

namespace impactdic {

const char* to_string(ImpactStatus status) {
  constexpr std::array kWords = {"found", "none", "wrong_side", "flight_too_short", "not_resolved"};
  return kWords[static_cast<std::size_t>(status)];
}

const char* to_string(ImpactFigure figure) {
  constexpr std::array kWords = {
      "vx before",    "vy before",          "vt before", "vn before",   "spin before",
      "vx after",     "vy after",           "vt after",  "vn after",    "spin after",
      "restitution",  "friction, Eq. 3.12", "friction",  "rolling cap", "closing inertia factor",
      "contact time", "deflection"};
  static_assert(kWords.size() == kImpactFigures);
  return kWords[static_cast<std::size_t>(figure)];
}

bool ImpactFigures::is_doubtful(ImpactFigure figure) const {
  return std::any_of(contradictions.begin(), contradictions.end(), [&](const Contradiction& c) {
    return std::find(c.figures.begin(), c.figures.end(), figure) != c.figures.end();
  });
}

const char* to_string(ErrorSource source) {
  constexpr std::array kWords = {"noise", "circle", "contact", "angle", "scale", "time", "camera"};
  return kWords[static_cast<std::size_t>(source)];
}

const char* to_string(ClosureVerdict verdict) {
  constexpr std::array kWords = {"undetermined", "closes", "signs", "lever_arm", "scale"};
  return kWords[static_cast<std::size_t>(verdict)];
}

}  // namespace impactdic
