// The rim of a ball by its rim model (the ink beside the edge, and the edge): lines across the rim,
// and the fit that makes them likeliest. More exact than the crossings of rim.h where the ball is
// at the rim as it is farther inside, and quicker once the model is known. Internal to host/circle.
//
//   trace_lines  short lines across a rim known to a pixel               (rim_lines.cpp)
//   RimModel     ink and edge, and what a line says under them           (rim_model.cpp)
//   fit_lines    circle or ellipse of the greatest likelihood            (line_fit.cpp)
#pragma once

#include <array>
#include <vector>

#include "host/circle/rim/lanes.h"
#include "host/circle/rim/rim.h"
#include "host/circle/sphere/sphere_light.h"

namespace impactdic::circle {

// The picture along short lines across the rim, at every pixel row or column that the rim crosses
// (whichever lies nearer to its normal): one sample every `step_px` from kInside steps inside the
// expected rim to kOutside outside, as shares of the local contrast (0 the background, 1 the ball's
// bare paint).
inline constexpr int kInside = 3, kOutside = 3;
inline constexpr int kSamples = kInside + 1 + kOutside;
typedef Lanes Profile;  // kSamples and a zero
// In the order of the angle.
struct RimLines {
  std::vector<Eight> profile;   // see Profile
  std::vector<float> cos, sin;  // direction from the rim's centre
  std::vector<float> weight;    // usual noise over this line's, squared
  std::vector<int> sector;      // 0 … kRimSectors − 1, by the angle
  // Sum of ln of the contrasts that the profile is in shares of; while a texture is learnt.
  std::vector<float> log_scale;

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  // Room for so many, of which fewer may be kept. The last of these stands for the rest of its
  // kLanes.
  void make_room(std::size_t lines);
  void keep(std::size_t lines);

 private:
  std::size_t size_ = 0;
};

// What a ball shows inside its rim: a picture that lies flat, or ink and light on a sphere, which
// both change more and more quickly towards the rim. An outline is a sphere whose rim is in parts
// hardly brighter than the background or darker: its profiles are in shares of one contrast for
// all lines, and what they show inside is anything that the light makes of ink and paint.
enum class Surface { kFlat, kSphere, kOutline };

struct LineTrace {
  // Grey levels, every ball made bright: see rim_levels.h.
  struct Levels {
    float noise = 0;  // of a sample
    float usual = 1;  // contrast
    std::array<float, kLevelSectors> ground{};
    std::array<float, 5> light{};  // of a flat ball
    SphereLight sphere;            // of a sphere
  } levels;
  RimLines lines;  // that show the background outside
  int cast = 0;
  int in_view = 0;
  int breaks = 0;  // runs of lines with something else outside
  double step_px = 1;
  double noise = 0;  // of a sample, share of the usual contrast
};
class TextureSums;
struct LineRequest {
  Polarity polarity = Polarity::kBright;
  double step_px = 1;
  int most_lines = 720;
  // The levels of the trace before are right (the same frame), or they are found anew.
  enum class Levels { kFoundAnew, kAsBefore } levels = Levels::kFoundAnew;
  TextureSums* texture = nullptr;  // gets what the ball looks like inside, if there is one
  Surface surface = Surface::kFlat;
  // Of a sphere: the width of the edge, and its light in an earlier frame.
  double edge_sigma_px = 0;
  const SphereLight* light = nullptr;
};
// Casts lines across `rim`. `trace` keeps its memory from call to call.
void trace_lines(const Frame& frame, const Rim& rim, const LineRequest& request, LineTrace& trace);

// The fit to the traced lines.
class RimModel;
inline constexpr int kKinds = 8;  // of lines, see RimModel
// ln of the shares of the kinds at the rim over those inside the ball.
typedef std::array<float, kKinds> KindShares;
struct LineFit {
  bool ok = false;
  Rim rim;
  bool ellipse = false;
  double sd[5] = {};  // cx, cy, r, e1, e2, were ink and edge exactly the model's
  // Their variances from lines all misplaced by the model, where its place_sd_px is 1 px.
  double misplaced[5] = {};
  double with_radius[2] = {};  // CircleFit::cx_with_r, cy_with_r
  RadiusOfFrame own;
  double residual_px = 0;  // scatter of the clean lines
  int points = 0;          // that have to do with the rim
  double arc = 0;          // share of the rim's kRimSectors sectors that hold such points
  KindShares shares{};
  double bare = 0;   // share of the rim's lines that show bare paint alone
  double wider = 1;  // see inflation
  // Where wanted: changes of ln σ of the edge that the lines ask for (WidthChange), and
  // RimModel::misfit.
  double width = 0, uneven_width = 0, misfit = 0;
};
enum class Thoroughness {
  kPreview,    // to a few hundredths of a step, from farther away
  kFinely,     // one frame of many that share a model
  kWithWidth,  // for what many frames share: no step is saved, and the width is asked for
};
struct LineStart {
  Thoroughness how = Thoroughness::kFinely;
  const Rim* from = nullptr;           // near the fit
  const KindShares* shares = nullptr;  // of a fit to the same frame
};
LineFit fit_lines(const LineTrace& trace, const RimModel& model, const Rim& rim,
                  const CirclePrior& prior, Shapes shapes, const LineStart& start);
// Mean of ln p of the lines' grey levels where the fit to them is.
double log_likelihood(const LineTrace& trace, const RimModel& model, const Rim& rim,
                      const LineFit& fit);
// A rough fit from farther away, by the area that the ball covers.
Rim rim_by_area(const LineTrace& trace, const Rim& rim);

}  // namespace impactdic::circle
