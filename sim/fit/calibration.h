// Calibration of an impact model on measured tracks (source sections 3.3.1 and 4.2.1, and the sound
// way: least squares on the trajectory).
#pragma once

#include <impactdic/fit.h>

#include "sim/shot/shot.h"

namespace impactdic::sim::fit {

// Sharpens when and where a measured contact begins, and how long it lasts, by the shape that the
// spring of `laws` gives to the path (restitution_duration.h); other laws leave the shot as it is.
void time_contact(MeasuredShot& shot, const ImpactJob& laws);

// A track and what it measures: without a model, as `track` has it, and with its contact timed by
// the laws, which is what they are fitted and compared with. Throws as calibrate.
struct LoadedShot {
  MeasuredTrack track;
  MeasuredShot shot, timed;
};
LoadedShot load_shot(const FitShot& source, const ImpactJob& laws, int flight_frames);

// Fits every shot. Throws FileError, FormatError or InvalidArgument naming file or key
// (request.validate()).
FitResult calibrate(const FitRequest& request, const RunControl& control = {});

// All that FitRequest::validate asks but for tracks, parameters and method: a comparison without a
// calibration has none.
void validate_settings(const FitRequest& request);

// The parameter of the laws in a job: read, write.
double law_parameter(const ImpactJob& job, FitParameter parameter);
void set_law_parameter(ImpactJob& job, FitParameter parameter, double value);
// Whether it is a number of BallShell.
bool is_of_shell(FitParameter parameter);
// The laws of a rigid ball in place of a shell.
ImpactJob one_spring(ImpactJob laws);
// The job of a measured shot: its surface and the motion before it.
ImpactJob job_of_shot(const ImpactJob& laws, const MeasuredShot& shot);

}  // namespace impactdic::sim::fit
