// A look at a clip: what the command `info` says of it.
#include <impactdic/error.h>

#include <algorithm>

#include "host/advice/clip_advice.h"
#include "host/circle/scout_ball.h"
#include "host/run/metres/camera_part.h"
#include "host/run/open_clip.h"

namespace impactdic {
namespace {

// Some pictures of a surface, whose texture may be coarser than the windows. More frames tell by
// what moves in them.
bool is_texture_alone(const Frame& first, const advice::AdviceRequest& request) {
  constexpr std::int64_t kSome = 5;
  constexpr int kCoarse_px = 31;
  if (advice::is_texture_alone(first, request.field)) return true;
  FieldOptions coarse = request.field;
  coarse.window_px = std::max(coarse.window_px, kCoarse_px);
  return request.frames.count() <= kSome && advice::is_texture_alone(first, coarse);
}

// Scouts for a ball, among the frames that advice reads. A picture of texture alone has none; so
// have speckles and holes, however round.
bool may_show_a_ball(FrameSource& source, advice::AdviceRequest& request) {
  try {
    Frame first;
    source.read(0, first);
    if (is_texture_alone(first, request)) return false;
  } catch (const Error&) {
    // A frame that cannot be read shows no ball: the others may.
  }
  const FrameRange looked = {0, advice::last_looked_at(source, request.frames) + 1, 1};
  const circle::Scouted found = circle::scout_ball(source, looked, request.roi, request.circle);
  if (found.balls.empty() || !found.is_believed(found.balls.front())) return false;
  request.radius_px = found.radius_px();
  request.scene = found.scene;
  return true;
}

// The ball's texture; that of the whole picture where there is no ball.
ClipAdvice look_at(FrameSource& source, const FieldOptions& field) {
  advice::AdviceRequest request;
  request.frames = {0, source.info().frame_count, 1};
  request.roi = {0, 0, source.info().width, source.info().height};
  request.field = field;
  if (may_show_a_ball(source, request)) {
    ClipAdvice advice = advice::advise_clip(source, request);
    if (advice.ball) return advice;
  }
  request.ball = false;
  return advice::advise_clip(source, request);
}

std::vector<BallSeen> candidates_of(const circle::Scouted& found) {
  std::vector<BallSeen> candidates;
  for (const circle::BallCandidate* ball : found.believed()) {
    BallSeen& seen = candidates.emplace_back();
    seen.radius_px = ball->radius_px;
    seen.rim_fraction = ball->rim_fraction;
    seen.moved_px = ball->moved_px;
    seen.frames = static_cast<int>(ball->sightings.size());
    const auto& plainest = *std::max_element(
        ball->sightings.begin(), ball->sightings.end(),
        [](const auto& a, const auto& b) { return a.ball.rim_fraction < b.ball.rim_fraction; });
    seen.place = plainest.ball.circle;
    seen.frame = plainest.index;
  }
  return candidates;
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
  if (!request.camera.empty()) {
    const Camera camera = read_camera(request.camera);
    run::check_camera_fits(camera, inspection.clip, request.camera);
    inspection.camera = figures_of(camera);
  }
  if (inspection.clip.has_timestamps && inspection.clip.frame_count > 1) {
    inspection.last_frame_time_s = source->frame_time_s(inspection.clip.frame_count - 1);
  }
  inspection.advice = look_at(*source, request.field);
  if (request.candidates) {
    const ClipInfo& info = source->info();
    const circle::Scouted found =
        circle::scout_ball(*source, {0, info.frame_count, 1}, {0, 0, info.width, info.height}, {});
    inspection.candidates = candidates_of(found);
    inspection.candidate_frames = found.frames;
  }
  inspection.warnings = run::all_warnings(request.clip, inspection.clip, inspection.advice);
  return inspection;
}

}  // namespace impactdic
