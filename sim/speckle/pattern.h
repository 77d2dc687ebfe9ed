// The sixteen painted balls of the speckle study, as lists of discs and lines.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace impactdic::sim::speckle {

// Ball axes: origin at the ball's centre, x right, y down at angle 0, px.
struct InkDisc {
  double x_px, y_px, radius_px;
};
struct InkLine {
  double x_px, y_px;  // its middle
  double angle_deg;   // counter-clockwise as seen on the screen
  double length_px, width_px;
};

// A ball and its ink. Any list of discs and lines may be rendered; none at all is a plain ball.
struct SpeckleBall {
  double radius_px = 115;
  std::vector<InkDisc> discs;
  std::vector<InkLine> lines;
};

// What section 2.3 of the source says of a pattern. Areas in px of the source's pictures.
struct PatternSpec {
  const char* name;        // "a1" … "f2"
  double density;          // share of dark pixels on the ball
  double mean_area_px;     // (a)–(d): of a speckle; 0 for (e), (f)
  double min_area_px = 0;  // (e), (f): areas lie between, log-uniform
  double max_area_px = 0;
  bool clusters = false;  // (e): random shapes, each several overlapping discs
  int lines = 0;          // (f): straight lines 2 px wide
};

// The sixteen of Fig. 2.3, in order. The density of e2 is not in the source; 0.60 is ours.
const std::vector<PatternSpec>& pattern_specs();
// Throws InvalidArgument naming the sixteen.
const PatternSpec& find_pattern(const std::string& name);

// Paints a ball. The same name, seed and radius give the same ball. Areas and density are those of
// the picture at half level (darker than the middle of white and ink) under the default lens
// (σ 0.6 px), which is how a picture of a real ball would be measured. Speckle sizes are pixels of
// the picture whatever the radius, as in the source: another radius changes their number.
// For radius 115 px density is within 0.5 points and mean area within 5 % (a3: 13 %, where
// neighbours touch). Throws InvalidArgument for an unknown name or a radius not in 20 … 2000 px.
SpeckleBall paint_ball(const std::string& pattern, std::uint64_t seed, double radius_px = 115);

// A picture's ink as an experimenter would measure it: threshold at half level, 8-connected
// components, those that touch the rim not counted among the areas.
struct InkMeasure {
  double density = 0;
  double mean_area_px = 0;
  int speckles = 0;
};
InkMeasure measure_ink(const SpeckleBall& ball);

}  // namespace impactdic::sim::speckle
