// The rim of a ball by its look: lines across the rim, and the fit that makes them likeliest. More
// exact than the crossings of rim.h where the ball looks at the rim as it does farther inside, and
// quicker once the look is known. Internal to host/track.
//
//   trace_lines  short lines across a rim known to a pixel               (rim_lines.cpp)
//   RimModel     the look, and what a line says under it                 (rim_model.cpp)
//   fit_lines    circle or ellipse of the greatest likelihood            (line_fit.cpp)
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include "host/circle/rim/rim.h"

// A function of vectors, compiled for AVX-512 too and chosen when the program starts; sanitizers
// are not ready by then.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define IMPACTDIC_WIDE __attribute__((target_clones("arch=x86-64-v4", "default")))
#else
#define IMPACTDIC_WIDE
#endif

namespace impactdic::circle {

// The picture along short lines across the rim, at every pixel row or column that the rim crosses
// (whichever lies nearer to its normal): one sample every `step_px` from kInside steps inside the
// expected rim to kOutside outside, as shares of the local contrast (0 the background, 1 the ball's
// bare paint).
inline constexpr int kInside = 3, kOutside = 3;
inline constexpr int kSamples = kInside + 1 + kOutside;
// Aligned as in functions compiled for wider vectors, whatever the others are compiled for.
typedef float Lanes __attribute__((vector_size(32), aligned(32)));
typedef int IntLanes __attribute__((vector_size(32), aligned(32)));
inline constexpr int kLanes = 8;
inline constexpr Lanes kCount = {0, 1, 2, 3, 4, 5, 6, 7};
inline float total_of(const Lanes& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}
// kLanes of them from memory.
template <typename Vector, typename T>
[[gnu::always_inline]] inline void load(const T* from, Vector& v) {
  static_assert(sizeof(Vector) == kLanes * sizeof(T));
  std::memcpy(&v, from, sizeof(v));
}

typedef Lanes Profile;  // kSamples and a zero
// For containers, which would lose the alignment of bare ones.
struct Eight {
  Lanes v;
};
// In the order of the angle.
struct RimLines {
  std::vector<Eight> profile;   // see Profile
  std::vector<float> cos, sin;  // direction from the rim's centre
  std::vector<float> weight;    // usual noise over this line's, squared
  std::vector<int> sector;      // 0 … kRimSectors − 1, by the angle

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  // Room for so many, of which fewer may be kept. The last of these stands for the rest of its
  // kLanes.
  void make_room(std::size_t lines);
  void keep(std::size_t lines);

 private:
  std::size_t size_ = 0;
};

struct LineTrace {
  // Grey levels, every ball made bright: noise, the background by sector of the rim, the bare paint
  // as a quadratic in the place.
  struct Levels {
    static constexpr int kSectors = 24;
    float noise = 0;
    float usual = 1;  // contrast
    std::array<float, kSectors> ground{};
    std::array<float, 5> light{};
  } levels;
  RimLines lines;  // that show the background outside
  int cast = 0;
  int in_view = 0;
  double step_px = 1;
  double noise = 0;  // of a sample, share of the usual contrast
};
class TextureSums;
// What a trace has to find beside the profiles: the levels are found anew, or those of the trace
// before are right (the same frame); `texture`, if there is one, gets what the ball looks like
// inside.
struct LineWants {
  bool levels = true;
  TextureSums* texture = nullptr;
};
// Casts at most `most_lines` lines across `rim`. `trace` keeps its memory from call to call.
void trace_lines(const Frame& frame, const Rim& rim, bool bright, double step_px, int most_lines,
                 const LineWants& wants, LineTrace& trace);

// The fit to the traced lines.
class RimModel;
inline constexpr int kKinds = 8;  // of lines, see RimModel
// ln of the shares of the kinds at the rim over those inside the ball.
typedef std::array<float, kKinds> KindShares;
struct LineFit {
  bool ok = false;
  Rim rim;
  bool ellipse = false;
  double sd[5] = {};  // cx, cy, r, e1, e2, were the look exactly the model's
  // Their variances from lines all misplaced by the look, where its place_sd_px is 1 px.
  double misplaced[5] = {};
  double residual_px = 0;  // scatter of the clean lines
  int points = 0;          // that have to do with the rim
  double arc = 0;          // share of the rim's kRimSectors sectors that hold such points
  KindShares shares{};
  // Where wanted: change of ln σ of the edge that the lines ask for, and RimModel::misfit.
  double width = 0, misfit = 0;
};
enum class Thoroughness { roughly, finely, with_width };
struct LineStart {
  Thoroughness how = Thoroughness::finely;
  const Rim* from = nullptr;           // near the fit
  const KindShares* shares = nullptr;  // of a fit to the same frame
};
LineFit fit_lines(const LineTrace& trace, const RimModel& model, const Rim& rim,
                  const CirclePrior& prior, bool allow_ellipse, const LineStart& start);
// A rough fit from farther away, by the area that the ball covers.
Rim rim_by_area(const LineTrace& trace, const Rim& rim);

}  // namespace impactdic::circle
