#include "host/run/settings/setting_texts.h"

#include <iterator>
#include <utility>

namespace impactdic::run {
namespace {

constexpr std::pair<const char*, const char*> kTexts[] = {
    {"ball-diameter-mm", "Scale: the ball's diameter"},
    {"ball-diameter-sd-mm", "Standard deviation of the diameter"},
    {"mm-per-px", "Scale: millimetres a pixel"},
    {"mm-per-px-sd", "Standard deviation of the millimetres a pixel"},
    {"camera",
     "Camera that `calibrate` wrote: coordinates are corrected; gives the scale unless the "
     "diameter "
     "is given"},
    {"camera-motion",
     "What is made of a background that moves, as before a camera that shakes: correct "
     "(velocities, "
     "impacts and metres are against it) or ignore (they are as the picture shows them)"},
    {"surface-angle-deg", "Inclination of the surface, counter-clockwise from image-right"},
    {"surface-angle-sd-deg", "Standard deviation of the inclination"},
    {"gravity-angle-deg", "Direction of gravity, counter-clockwise from image-right"},
    {"drop-height-mm",
     "Height that the ball fell freely to the touch: a check of scale and frame rate"},
    {"inertia-factor",
     "I / (m R^2) of the ball: 0.667 hollow, 0.4 solid; for rolling cap and closure"},
    {"distance-mm", "Of the camera from the ball: gives the velocity along the line of sight"},
    {"distance-sd-mm", "Standard deviation of the distance"},
    {"frames", "A:B[:STEP]: frames analysed, B excluded"},
    {"roi", "X,Y,W,H: the rectangle that is looked at, px"},
    {"radius-px", "LO:HI: range of the ball's radius, px"},
    {"ball-at",
     "FRAME:X,Y,R/FRAME:none/...: frames corrected by hand: the ball's circle there, px, or that "
     "there is none"},
    {"ball", "N: which of several balls is measured, as info --candidates counts them"},
    {"estimator",
     "How the motion is measured: ball (one registration of the whole ball, the most exact, and "
     "poses without drift), field (windows alone) or ring (rotation from rings, any angle)"},
    {"body",
     "What turns: sphere (about any axis), disc (in the picture's plane) or auto (as the "
     "pictures show)"},
    {"no-field", "Circle only: no displacement field"},
    {"no-checksum",
     "Leave out the SHA-256 of the clip and of the results: both are read once more"},
    {"overlay", "Annotated frames as PNGs and as MP4: circle, path, arrows, phase, spin"},
    {"slow-motion",
     "How many times slower than life the overlay's video plays; 0: every frame, 25 a second"},
    {"arrow-scale",
     "Length of the overlay's arrows over the displacement to the next frame; 0: by the ball's "
     "first motion"},
    {"window", "Side of an interrogation window, px"},
    {"spacing", "Distance of the windows' centres, px; 0 is half a window"},
    {"search", "Largest displacement searched about the expected one, px each way"},
    {"method",
     "icgn (ZNCC, then IC-GN with affine warp), zncc (FFT cross-correlation normalised over the "
     "overlap), equal (equal windows of 16 or 32 px, Gaussian peak: quickest, least exact) or "
     "published (equal windows, spline points)"},
    {"interp", "Spline points between pixels of the published method, 0 to 9"},
    {"spline-degree", "B-spline of the IC-GN warp: 3, 5 or 7"},
    {"max-iterations", "Most steps of the IC-GN refinement of a window"},
    {"min-correlation", "ZNCC below which a window counts as not found"},
    {"min-texture",
     "Contrast of a window (rms, grey levels of 255, without the noise) below which it is left "
     "out"},
    {"max-sd",
     "Standard deviation, px, that the clip's noise lets expect of a window's displacement, "
     "above which it is left out (icgn)"},
    {"compress", "Deflate fields.h5 at this level, 1 to 9; 0: not at all"},
    {"video",
     "Clip: .cine, .mraw/.cih/.cihx, .tif (multi-page), .avi/.mp4/.mov/.mkv, a folder or quoted "
     "glob of pictures, several pictures, or raw pixels with --raw"},
    {"raw", "WIDTHxHEIGHTxBITS: the file is bare pixels"},
    {"fps", "Frames a second; overrides the file's own rate"},
    {"channel",
     "Of a colour picture: red, green or blue, instead of its luminance. A ball as grey as the "
     "background may differ in its colour"},
    {"gamma",
     "Grey levels go as light to the power of 1 / gamma, and are turned back to light: 2.2 for "
     "most film, 1 where they are light"},
    {"max-megapixels", "Largest picture that is read, 10^6 pixels"},
    {"reference", "Measure against: first or previous"},
    {"mask", "Picture: only its non-zero pixels are measured"},
    {"polygon",
     "X,Y,X,Y,X,Y...: corners, px: what is looked at: only pixels inside are measured, and a "
     "ball's "
     "centre lies inside"},
    {"motion",
     "Rigid motion of the region: windows (robust fit to their displacements) or region (one "
     "registration of all its pixels, for rigid bodies)"},
};

}  // namespace

const std::map<std::string, std::string>& setting_texts() {
  static const std::map<std::string, std::string> texts(std::begin(kTexts), std::end(kTexts));
  return texts;
}

}  // namespace impactdic::run
