// Tracks a ball in pictures that lie in the program's own memory, as those of a camera do.
//
//     impactdic synth -o clip --simulate job.toml --frames 110
//     track_from_memory clip/video.tif 10000 67
#include <impactdic/impactdic.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace idic = impactdic;

int main(int count, char** arguments) try {
  if (count != 4) {
    std::fprintf(stderr, "usage: track_from_memory CLIP FRAMES_PER_SECOND BALL_DIAMETER_MM\n");
    return 2;
  }
  // Your pictures. Here they come from a file; frames of one size and depth from anywhere will do.
  const auto file = idic::open_clip({arguments[1]});
  std::vector<idic::Frame> pictures(file->info().frame_count);
  for (std::size_t i = 0; i < pictures.size(); ++i) file->read(i, pictures[i]);

  // A clip of borrowed pictures: nothing is copied, so they must stay until the run is over.
  idic::MemoryClip memory;
  memory.width = file->info().width;
  memory.height = file->info().height;
  memory.bits = file->info().bits;
  for (const idic::Frame& picture : pictures) memory.frames.push_back(picture.bytes());

  idic::TrackRequest request;
  request.clip.source = idic::clip_from_memory(memory);
  request.clip.fps = std::atof(arguments[2]);
  request.ball_diameter_mm = std::atof(arguments[3]);

  idic::Session session;  // the best OpenCL device and all cores; several runs may share it
  const idic::TrackResult result = idic::track(request, session);

  std::printf("frame cx_px cx_sd_px dx_px dx_sd_px rot_deg rot_sd_deg vx_m_s omega_rad_s\n");
  for (const idic::TrackRow& row : result.rows) {
    if (!row.motion_ok) continue;
    const idic::SiRow si = idic::to_si(row, result.scale);
    std::printf("%lld %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", (long long)row.frame, row.cx_px,
                row.cx_sd_px, row.dx_px, row.dx_sd_px, row.rot_deg, row.rot_sd_deg, si.vx_m_s,
                si.omega_rad_s);
  }
  const idic::ImpactFigures& impact = result.impact_si;
  std::printf("impact: %s\n", idic::to_string(impact.status));
  if (impact.found()) {
    std::printf("restitution %.9g sd %.9g\n", impact.restitution.value, impact.restitution.sd);
  }
  for (const std::string& warning : result.warnings) std::printf("warning: %s\n", warning.c_str());
} catch (const idic::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());  // WHAT (WHERE): HINT
  return 1;
}
