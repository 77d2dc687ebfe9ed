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
// The same, and no darker towards its limb: what is wrong with its rim is its ink.
bool is_plainly_lit(const LineTrace& trace);

// What the ink looks like along lines across the rim, from strips of the surface that face the
// camera, foreshortened as they would be at the rim: gives them to the request's texture.
void add_sphere_texture(const Frame& frame, const Rim& rim, const LineRequest& request,
                        const LineTrace& trace);

// How much brighter bare paint is beside the rim than the light has it. The light is an envelope of
// what is seen: of fine ink, foreshortened, that shows no bare paint there, and the ball seems to
// darken towards its rim. Its mean level does not: by how much more the lines show inside than
// the texture, as far as that is beyond chance and the light darkens.
double paint_beside_rim(const LineTrace& trace, const TextureSums& texture);

}  // namespace impactdic::circle
