// A look at a clip: what the command `info` says of it.
#include <impactdic/error.h>

#include "host/advice/clip_advice.h"
#include "host/run/open_clip.h"

namespace impactdic {
namespace {

// The ball's texture; that of the whole picture where there is no ball.
ClipAdvice look_at(FrameSource& source, const FieldOptions& field) {
  advice::AdviceRequest request;
  request.frames = {0, source.info().frame_count, 1};
  request.roi = {0, 0, source.info().width, source.info().height};
  request.field = field;
  ClipAdvice advice = advice::advise_clip(source, request);
  if (advice.ball) return advice;
  request.ball = false;
  return advice::advise_clip(source, request);
}

}  // namespace

void InspectRequest::validate() const {
  clip.validate();
  field.validate();
}

Inspection inspect(const InspectRequest& request) {
  request.validate();
  const auto source = run::open_requested(request.clip);
  Inspection inspection;
  inspection.clip = source->info();
  if (inspection.clip.frame_count < 1) {
    throw InvalidArgument("the clip has no frames", inspection.clip.path);
  }
  if (inspection.clip.has_timestamps && inspection.clip.frame_count > 1) {
    inspection.last_frame_time_s = source->frame_time_s(inspection.clip.frame_count - 1);
  }
  inspection.advice = look_at(*source, request.field);
  inspection.warnings = run::all_warnings(request.clip, inspection.clip, inspection.advice);
  return inspection;
}

}  // namespace impactdic
