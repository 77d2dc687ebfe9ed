// What is known of clips and cameras, in lines for people.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/camera/calibrate.h>

#include <string>

namespace impactdic::report {

// A line each, "label            value": the file, the ball, the texture and the warnings.
// `error_px`: the error that a person wants to reach; says which window reaches it.
std::string in_words(const Inspection& found, double error_px);

// Scale, distortion, tilt and what is to be thought of them, a line each.
std::string in_words(const CalibrateResult& found);

}  // namespace impactdic::report
