// Displacement fields: what is asked for, and what comes back of each interrogation window.
#pragma once

#include <impactdic/export.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

struct Window;        // of the kernels; see FieldView
struct WindowMotion;  // the same

// How a window's displacement is measured.
enum class FieldMethod : std::uint8_t {
  // The dissertation's section 2.2: both windows mean-free, spline interpolation with N points
  // between pixels, FFT cross-correlation of equal zero-padded windows, largest value. Biased
  // towards zero; kept so that the published numbers can be remade.
  kPublished,
  // Template window in a larger search area, ZNCC (Lewis 1995) with the numerator by FFT, peak of
  // the spline through the correlation map. Unbiased.
  kZncc,
  // Equal windows of 16 or 32 px, the classic interrogation of particle images: circular
  // cross-correlation by FFT, each value over the share of the windows that overlaps at its lag,
  // Gaussian through the peak (Westerweel 1997). Finds displacements below half a window about the
  // guess, whatever search_px. The quickest; what leaves the window
  // is lost to it, so that it errs the more the further its guess is off.
  kEqual,
  // ZNCC seed, then inverse-compositional Gauss–Newton on an affine warp with B-spline
  // interpolation (Pan, Li and Tong 2013).
  kIcgn,
};
const char* to_string(FieldMethod method);
FieldMethod parse_field_method(const std::string& name);  // throws InvalidArgument

struct FieldOptions {
  FieldMethod method = FieldMethod::kIcgn;
  int window_px = 15;       // interrogation window (subset), odd or even, 5 … 129; equal: 16, 32
  int search_px = 8;        // largest displacement searched about the guess, each way, 1 … 128
  int interp_points = 5;    // spline points between pixels of the published method, 0 … 9
  int spline_degree = 5;    // B-spline of the IC-GN warp: 3, 5 or 7
  int max_iterations = 30;  // of IC-GN, 1 … 1000
  double min_correlation = 0.6;  // ZNCC below which a window is low_correlation, 0 … 1
  double min_texture = 1.0;  // rms contrast of a window, grey levels of 255, below which no_texture
  // Of IC-GN: the camera's noise (standard deviation of a pixel, grey levels of 255; 0: rounding to
  // whole grey levels alone), and the expected standard deviation of a window's displacement, px,
  // above which no_texture. What is expected is the Cramér–Rao bound of an affine window in two
  // pictures of that noise, whose own slopes are taken out of the information. The runs of track.h
  // and correlate.h measure the noise themselves and leave what stands here out.
  double noise = 0;
  double max_sd_px = 0.07;
  void validate() const;  // throws InvalidArgument naming the option
};

// What came of a window. The values stand in files.
enum class WindowStatus : std::int32_t {
  kOk = 0,
  kMasked = 1,          // not (wholly) on the surface to be measured
  kNoTexture = 2,       // too little contrast, or none that tells of both components
  kLowCorrelation = 3,  // best ZNCC below the threshold
  kAtSearchEdge = 4,    // the peak lies on the edge of the search area: it may be larger
  kNotConverged = 5,    // IC-GN left its window or ran out of iterations
  kOutOfView = 6,       // the window or its search area leaves the picture
};
const char* to_string(WindowStatus status);

// One window, px in the whole picture's axes (x right, y down). Everything but place and status is
// NaN where the status is not ok, the peak ratio also where the window was not searched for.
struct WindowResult {
  WindowStatus status = WindowStatus::kMasked;
  double x_px = 0, y_px = 0;             // its centre in the first frame
  float u_px = 0, v_px = 0;              // displacement of the centre to the second frame
  float u_sd_px = 0, v_sd_px = 0;        // one standard deviation
  float correlation = 0;                 // ZNCC, −1 … 1
  float peak_ratio = 0;                  // highest peak over the highest one elsewhere
  float ux = 0, uy = 0, vx = 0, vy = 0;  // du/dx, du/dy, dv/dx, dv/dy
};

// The field of one frame as a run holds it; plain results are made only where they are asked for.
// Valid as long as the object that handed it out says.
class FieldView {
 public:
  FieldView() = default;
  FieldView(std::span<const Window> windows, std::span<const WindowMotion> motions, int window_px);

  // Windows of the field; 0 where none was measured in this frame.
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  // Throws nothing; `index` must be below size().
  WindowResult operator[](std::size_t index) const;
  std::vector<WindowResult> windows() const;

 private:
  const Window* windows_ = nullptr;
  const WindowMotion* motions_ = nullptr;
  std::size_t count_ = 0;
  int window_px_ = 0;
};

}  // namespace impactdic
