// The parts of a SynthRequest that a person writes as text.
#pragma once

#include <impactdic/synth.h>

#include <string>
#include <vector>

namespace impactdic::run {

// As `synth` takes them; empty: not given.
struct SynthTexts {
  std::string body = "disc";              // or sphere
  std::string size = "512x512";           // WIDTHxHEIGHT, px
  std::string velocity = kUsualVelocity;  // DX,DY[,DZ], px a frame
  std::string spin;                       // X,Y,Z or Z, degrees a frame
  std::string start;                      // X,Y of the centre in frame 0, px
  std::string motion_file;                // a table of motions
  std::string impact_job;                 // a job of simulate
  std::vector<double> distortion;         // K1[, K2]
  ConstantMotion step;                    // what the texts above do not say of a constant motion
  double touch_frame = 25;                // of an impact

  static constexpr const char* kUsualVelocity = "1,0";
};

// Puts what the texts say into the request; reads the motion's file. Throws InvalidArgument for a
// text that says nothing possible and for a motion that is given twice; FileError, FormatError.
void apply(const SynthTexts& texts, SynthRequest& request);

}  // namespace impactdic::run
