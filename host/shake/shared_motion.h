// Whether the ball moves with what lies behind it, as before a camera that shakes.
#pragma once

#include <impactdic/track.h>

#include <string>

#include "host/clip/track_rows.h"

namespace impactdic::shake {

// False where the ball flies on while the background moves: a floor or a racket gives way, and the
// camera stands still. By how much the paths of both are bent, where the background's
// plainly is; true where too few frames tell. `rows`: as the pictures show them.
bool moves_with_ball(const CameraMotion& motion, const TrackRows& rows);

// For people: what that was, one line.
std::string by_itself_in_words(const CameraMotion& motion);

}  // namespace impactdic::shake
