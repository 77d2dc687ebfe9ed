// How much the libraries that decode clips are trusted.
#pragma once

#include <impactdic/export.h>

namespace IMPACTDIC_PUBLIC impactdic {

// Whether clips in containers (.avi .mp4 .mov .mkv) are decoded in a process of their own, which
// has no more than the file, a limit of memory and no way to write. True until it is set; holds for
// all clips that are opened from then on, whatever thread does. Off, a fault of FFmpeg's is a fault
// of this process.
void set_sandbox(bool on);
bool has_sandbox();

// The same for pictures (.png .jpg .bmp .pgm .tif): alone, as a sequence, or the pages of one .tif.
// False until it is set: one process decodes them one after the other, which takes longer than
// several threads here.
void set_picture_sandbox(bool on);
bool has_picture_sandbox();

}  // namespace impactdic
