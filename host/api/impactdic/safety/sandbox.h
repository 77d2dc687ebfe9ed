// How much the libraries that decode containers are trusted.
#pragma once

#include <impactdic/export.h>

namespace IMPACTDIC_PUBLIC impactdic {

// Whether clips in containers (.avi .mp4 .mov .mkv) are decoded in a process of their own, which
// has no more than the file, a limit of memory and no way to write. True until it is set; holds for
// all clips that are opened from then on, whatever thread does. Off, a fault of FFmpeg's is a fault
// of this process.
void set_sandbox(bool on);
bool has_sandbox();

}  // namespace impactdic
