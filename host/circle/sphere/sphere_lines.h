// Lines across the rim of a sphere, and its ink foreshortened. Internal to host/circle.
#pragma once

#include <vector>

#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_lines.h"

namespace impactdic::circle {

// Keeps the lines that show background outside and ball inside. A profile is in shares of what bare
// paint shows at each of its samples, which light and limb change along it. `grounds`: the
// background at each line.
void keep_clear_sphere_lines(const CastLines& lines, const std::vector<float>& grounds,
                             const Rim& rim, const LineRequest& request, LineTrace& trace);

// Keeps the lines that show background outside and something else inside. A profile is in shares of
// the usual contrast.
void keep_outline_lines(const CastLines& lines, const std::vector<float>& grounds,
                        LineTrace& trace);

// Whether the sphere stands out of the background by about as much at each of the kept lines.
bool is_evenly_lit(const LineTrace& trace);

// What the ink looks like along lines across the rim, from strips of the surface that face the
// camera, foreshortened as they would be at the rim: gives them to the request's texture.
void add_sphere_texture(const Frame& frame, const Rim& rim, const LineRequest& request,
                        const LineTrace& trace);

}  // namespace impactdic::circle
